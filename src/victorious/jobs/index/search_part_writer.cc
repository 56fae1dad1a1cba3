#include "victorious/jobs/index/search_part_writer.h"

#include <algorithm>

namespace victorious {

DamageFinder::DamageFinder(const VideoReader& reader) : reader_(reader) {
  constexpr double kMinPause_s = 0.25;
  constexpr double kFrames = 2.5;
  const double rate = reader.info().frame_rate;
  min_pause_s_ = rate > 0 ? std::max(kMinPause_s, kFrames / rate) : 1;
}

void DamageFinder::Enter(const Frame& frame) {
  const double before_s = std::exchange(last_time_s_, frame.time_s);
  last_frame_ = frame.index;
  const bool is_known = reader_.info().live || reader_.has_damage();
  if (is_known && frame.time_s - before_s > min_pause_s_) {
    found_ = {.from_s = found_ ? found_->from_s : before_s, .to_s = frame.time_s};
  }
}

std::optional<DamagedTime> DamageFinder::Finish() const {
  const VideoInfo& info = reader_.info();
  if (!info.duration_s || info.is_duration_estimated || !reader_.has_damage()) return std::nullopt;
  if (*info.duration_s - last_time_s_ <= min_pause_s_) return std::nullopt;
  return DamagedTime{.from_s = last_time_s_, .to_s = *info.duration_s};
}

SearchPartWriter::SearchPartWriter(std::span<const SearchRecord> searches, std::int64_t step)
    : searches_(searches), step_(step) {}

void SearchPartWriter::Resume(std::span<const SearchPart> stored) {
  for (const SearchRecord& search : searches_) {
    const auto last = std::ranges::find_if(stored, [&](const SearchPart& part) {
      return part.model == search.model && part.to_frame == search.next_frame && part.to_frame > part.from_frame;
    });
    if (last != stored.end()) parts_.push_back(*last);
  }
  // They differ only if an older version made some of them.
  const bool are_alike =
      std::ranges::all_of(parts_, [&](const SearchPart& part) { return part.kind == parts_.front().kind; });
  if (parts_.size() != searches_.size() || !are_alike) parts_.clear();
}

void SearchPartWriter::Enter(std::int64_t frame, double time_s, bool left_out,
                             const std::optional<DamagedTime>& damaged) {
  double from_s = time_s;
  if (damaged && !parts_.empty()) {
    ExtendTo(parts_.front().to_frame, damaged->from_s);
    EnterDamage(*damaged);
    from_s = damaged->to_s;
  }
  if (!parts_.empty() && frame - parts_.front().to_frame >= step_) End();
  if (left_out) left_out_s_ = time_s;
  const bool is_thinned = left_out_s_ && time_s - *left_out_s_ < kThinned_s;
  const SearchPartKind kind = is_thinned ? SearchPartKind::kThinned : SearchPartKind::kSearched;
  if (!parts_.empty() && parts_.front().kind != kind) {
    for (SearchPart& part : parts_) part.to_frame = frame;
    End();
  }
  if (parts_.empty()) Begin(kind, frame, from_s);
  for (SearchPart& part : parts_) {
    part.to_frame = frame + 1;
    part.to_s = time_s;
  }
  is_changed_ = true;
}

void SearchPartWriter::ExtendTo(std::int64_t frame, double time_s) {
  for (SearchPart& part : parts_) {
    if (time_s <= part.to_s) continue;
    part.to_frame = std::max(part.to_frame, frame + 1);
    part.to_s = time_s;
    is_changed_ = true;
  }
}

void SearchPartWriter::EnterDamage(const DamagedTime& damaged) {
  if (parts_.empty()) return;
  const std::int64_t frame = parts_.front().to_frame;
  End();
  for (const SearchRecord& search : searches_) {
    ended_.push_back({.video = search.video,
                      .model = search.model,
                      .kind = SearchPartKind::kDamaged,
                      .from_frame = frame,
                      .to_frame = frame,
                      .from_s = damaged.from_s,
                      .to_s = damaged.to_s});
  }
}

void SearchPartWriter::MoveTo(IndexBatch& batch) {
  batch.parts.insert(batch.parts.end(), ended_.begin(), ended_.end());
  ended_.clear();
  if (is_changed_) batch.parts.insert(batch.parts.end(), parts_.begin(), parts_.end());
  is_changed_ = false;
}

void SearchPartWriter::Begin(SearchPartKind kind, std::int64_t frame, double time_s) {
  for (const SearchRecord& search : searches_) {
    parts_.push_back({.video = search.video,
                      .model = search.model,
                      .kind = kind,
                      .from_frame = frame,
                      .to_frame = frame,
                      .from_s = time_s,
                      .to_s = time_s});
  }
}

void SearchPartWriter::End() {
  if (is_changed_) ended_.insert(ended_.end(), parts_.begin(), parts_.end());
  is_changed_ = false;
  parts_.clear();
}

}  // namespace victorious
