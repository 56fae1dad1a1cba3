// A SegmentStore in memory, for the tests of what uses one; the contract is tested on it, too.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/store/segment_store.h"

namespace victorious::testing {

class MemorySegmentStore final : public SegmentStore {
 public:
  [[nodiscard]] Status Put(const VideoCut& cut, std::span<const std::byte> prepared) override {
    if (cuts_.contains(cut.video) && cuts_.at(cut.video).cut.plan == cut.plan) return {};
    cuts_[cut.video] = {cut, {prepared.begin(), prepared.end()}, {}};
    return {};
  }

  [[nodiscard]] Expected<std::optional<VideoCut>> Find(std::int64_t video) override {
    return cuts_.contains(video) ? std::optional(cuts_.at(video).cut) : std::nullopt;
  }

  [[nodiscard]] Expected<std::vector<std::byte>> Prepared(std::int64_t video) override {
    if (!cuts_.contains(video)) return Fail(ErrorCode::kNotFound, "not cut");
    return cuts_.at(video).prepared;
  }

  [[nodiscard]] Status Complete(std::int64_t video, const std::string& plan, FrameInterval frames,
                                std::span<const std::byte> results) override {
    Segment* segment = Of(video, frames);
    if (segment == nullptr || cuts_.at(video).cut.plan != plan) return Fail(ErrorCode::kConflict, "no such segment");
    if (segment->state == SegmentState::kDone) return {};
    *segment = {.frames = frames, .state = SegmentState::kDone, .reason = {}};
    cuts_.at(video).results[frames.from].assign(results.begin(), results.end());
    return {};
  }

  [[nodiscard]] Status VisitResults(
      std::int64_t video, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) override {
    if (!cuts_.contains(video)) return {};
    for (const Segment& segment : cuts_.at(video).cut.segments) {
      if (segment.state != SegmentState::kDone) continue;
      VICTORIOUS_RETURN_IF_ERROR(visit(segment.frames, cuts_.at(video).results.at(segment.frames.from)));
    }
    return {};
  }

  [[nodiscard]] Status SetWhole(std::int64_t video, const std::string& plan) override {
    if (cuts_.contains(video) && cuts_.at(video).cut.plan == plan) cuts_.at(video).cut.is_whole = true;
    return {};
  }

  [[nodiscard]] Status GiveUp(std::int64_t video, FrameInterval frames, const std::string& reason) override {
    Segment* segment = Of(video, frames);
    if (segment == nullptr || segment->state != SegmentState::kOpen) return {};
    VideoCut& cut = cuts_.at(video).cut;
    if (const auto middle = MiddleOf(frames, cut.step)) {
      segment->frames.to = *middle;
      cut.segments.push_back({.frames = {*middle, frames.to}, .state = {}, .reason = {}});
      std::ranges::sort(cut.segments, {}, &Segment::frames);
    } else {
      *segment = {.frames = frames, .state = SegmentState::kQuarantined, .reason = reason};
    }
    return {};
  }

  [[nodiscard]] Status Finish(std::int64_t video, const std::string& plan, std::span<const std::int64_t> models,
                              std::span<const CoverageGap> gaps) override {
    if (!cuts_.contains(video) || cuts_.at(video).cut.plan != plan) return {};
    cuts_.erase(video);
    if (models.empty()) return {};
    std::erase_if(gaps_, [&](const CoverageGap& gap) { return gap.video == video; });
    gaps_.insert(gaps_.end(), gaps.begin(), gaps.end());
    return {};
  }

  [[nodiscard]] Expected<std::vector<CoverageGap>> Gaps() override { return gaps_; }

 private:
  struct Kept {
    VideoCut cut;
    std::vector<std::byte> prepared;
    std::map<std::int64_t, std::vector<std::byte>> results;  // by the first frame of the segment
  };

  Segment* Of(std::int64_t video, FrameInterval frames) {
    if (!cuts_.contains(video)) return nullptr;
    std::vector<Segment>& segments = cuts_.at(video).cut.segments;
    const auto found = std::ranges::find(segments, frames, &Segment::frames);
    return found == segments.end() ? nullptr : &*found;
  }

  std::map<std::int64_t, Kept> cuts_;
  std::vector<CoverageGap> gaps_;
};

}  // namespace victorious::testing
