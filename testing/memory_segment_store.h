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
  [[nodiscard]] Expected<std::int64_t> Put(const VideoCut& cut, std::span<const std::int64_t> models,
                                           std::span<const std::byte> prepared,
                                           std::span<const std::vector<std::byte>> of_segments) override {
    for (const auto& [id, kept] : cuts_) {
      if (kept.cut.video == cut.video && kept.cut.plan == cut.plan) return id;
    }
    std::erase_if(cuts_, [&](const auto& one) {
      return one.second.cut.video == cut.video &&
             std::ranges::find_first_of(one.second.models, models) != one.second.models.end();
    });
    VideoCut stored = cut;
    stored.id = ++last_id_;
    cuts_[stored.id] = {stored, {models.begin(), models.end()}, {prepared.begin(), prepared.end()}, {}, {}};
    for (std::size_t i = 0; i < cut.segments.size(); ++i) {
      cuts_[stored.id].of_segments[cut.segments[i].frames.from] =
          of_segments.empty() ? std::vector<std::byte>() : of_segments[i];
    }
    return stored.id;
  }

  [[nodiscard]] Expected<std::optional<VideoCut>> Find(std::int64_t cut) override {
    return cuts_.contains(cut) ? std::optional(cuts_.at(cut).cut) : std::nullopt;
  }

  [[nodiscard]] Expected<std::vector<VideoCut>> CutsOf(std::int64_t video) override {
    std::vector<VideoCut> cuts;
    for (const auto& [id, kept] : cuts_) {
      if (kept.cut.video == video) cuts.push_back(kept.cut);
    }
    return cuts;
  }

  [[nodiscard]] Expected<std::vector<std::byte>> Prepared(std::int64_t cut) override {
    if (!cuts_.contains(cut)) return Fail(ErrorCode::kNotFound, "not cut");
    return cuts_.at(cut).prepared;
  }

  [[nodiscard]] Expected<std::vector<std::byte>> PreparedOf(std::int64_t cut, FrameInterval frames) override {
    const Segment* segment = Of(cut, frames);
    if (segment == nullptr || segment->state != SegmentState::kOpen) return Fail(ErrorCode::kNotFound, "not open");
    return cuts_.at(cut).of_segments.at(frames.from);
  }

  [[nodiscard]] Status Discard(std::int64_t cut, std::int64_t frame) override {
    if (!cuts_.contains(cut)) return {};
    for (const Segment& segment : cuts_.at(cut).cut.segments) {
      if (segment.frames.to <= frame) cuts_.at(cut).results.erase(segment.frames.from);
    }
    return {};
  }

  [[nodiscard]] Status Complete(std::int64_t cut, FrameInterval frames, std::span<const std::byte> results) override {
    Segment* segment = Of(cut, frames);
    if (segment == nullptr) return Fail(ErrorCode::kNotFound, "no such segment");
    if (segment->state != SegmentState::kOpen) return {};
    *segment = {.frames = frames, .state = SegmentState::kDone, .reason = {}};
    cuts_.at(cut).results[frames.from].assign(results.begin(), results.end());
    return {};
  }

  [[nodiscard]] Status VisitResults(
      std::int64_t cut, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) override {
    if (!cuts_.contains(cut)) return Fail(ErrorCode::kNotFound, "not cut");
    for (const Segment& segment : cuts_.at(cut).cut.segments) {
      const auto found = cuts_.at(cut).results.find(segment.frames.from);
      if (segment.state != SegmentState::kDone || found == cuts_.at(cut).results.end()) continue;
      VICTORIOUS_RETURN_IF_ERROR(visit(segment.frames, found->second));
    }
    return {};
  }

  [[nodiscard]] Status SetWhole(std::int64_t cut) override {
    if (cuts_.contains(cut)) cuts_.at(cut).cut.is_whole = true;
    return {};
  }

  [[nodiscard]] Status GiveUp(std::int64_t id, FrameInterval frames, const std::string& reason) override {
    Segment* segment = Of(id, frames);
    if (segment == nullptr || segment->state != SegmentState::kOpen) return {};
    VideoCut& cut = cuts_.at(id).cut;
    if (const auto middle = MiddleOf(frames, cut.step)) {
      segment->frames.to = *middle;
      cuts_.at(id).of_segments[*middle] = cuts_.at(id).of_segments.at(frames.from);
      cut.segments.push_back({.frames = {*middle, frames.to}, .state = {}, .reason = {}});
      std::ranges::sort(cut.segments, {}, &Segment::frames);
    } else {
      *segment = {.frames = frames, .state = SegmentState::kQuarantined, .reason = reason};
    }
    return {};
  }

  [[nodiscard]] Status Finish(std::int64_t cut, std::span<const CoverageGap> gaps) override {
    if (!cuts_.contains(cut)) return {};
    std::erase_if(gaps_, [&](const CoverageGap& gap) { return gap.video == cuts_.at(cut).cut.video; });
    gaps_.insert(gaps_.end(), gaps.begin(), gaps.end());
    cuts_.erase(cut);
    return {};
  }

  [[nodiscard]] Expected<std::vector<CoverageGap>> Gaps() override { return gaps_; }

  [[nodiscard]] Expected<std::vector<QuarantinedSegment>> Quarantined() override {
    std::vector<QuarantinedSegment> all;
    for (const auto& [id, kept] : cuts_) {
      for (const Segment& one : kept.cut.segments) {
        if (one.state == SegmentState::kQuarantined) all.push_back({kept.cut.video, one.frames, one.reason});
      }
    }
    return all;
  }

 private:
  struct Kept {
    VideoCut cut;
    std::vector<std::int64_t> models;
    std::vector<std::byte> prepared;
    std::map<std::int64_t, std::vector<std::byte>> results;  // by the first frame of the segment
    std::map<std::int64_t, std::vector<std::byte>> of_segments;
  };

  Segment* Of(std::int64_t cut, FrameInterval frames) {
    if (!cuts_.contains(cut)) return nullptr;
    std::vector<Segment>& segments = cuts_.at(cut).cut.segments;
    const auto found = std::ranges::find(segments, frames, &Segment::frames);
    return found == segments.end() ? nullptr : &*found;
  }

  std::map<std::int64_t, Kept> cuts_;  // by id
  std::int64_t last_id_ = 0;
  std::vector<CoverageGap> gaps_;
};

}  // namespace victorious::testing
