// Divides the frames of a pass into the parts that the store keeps (SearchPart): what was searched, what only in part
// to keep a pace, and what is damaged.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "victorious/input/video/video_reader.h"
#include "victorious/store/index_store.h"
#include "victorious/types/frame.h"

namespace victorious {

/// A time without frames because the video is damaged: from the last frame before it to the first one after it, s.
struct DamagedTime {
  double from_s = 0;
  double to_s = 0;
};

/// Finds damaged times while a video is read: pauses between frames of a video whose reader has warned, or of a live
/// source.
class DamageFinder {
 public:
  explicit DamageFinder(const VideoReader& reader);

  /// Call for each frame, in order, from the thread that reads.
  void Enter(const Frame& frame);
  /// The time that was found since the last call.
  [[nodiscard]] std::optional<DamagedTime> Take() { return std::exchange(found_, std::nullopt); }
  /// The frame that was entered last, and its time; 0 before the first one.
  [[nodiscard]] std::int64_t last_frame() const { return last_frame_; }
  [[nodiscard]] double last_time_s() const { return last_time_s_; }
  /// Call after the last frame. @return the time after it, by the length that the container says
  [[nodiscard]] std::optional<DamagedTime> Finish() const;

 private:
  const VideoReader& reader_;
  double min_pause_s_;
  std::int64_t last_frame_ = 0;
  double last_time_s_ = 0;
  std::optional<DamagedTime> found_;
};

/// Use from one thread at a time.
class SearchPartWriter {
 public:
  /// A part stays thinned until no search was left out for so long: a live source would have thousands of parts.
  static constexpr double kThinned_s = 10;

  /// @param searches  of the pass
  /// @param step      most frames between two that the pass enters; another jump begins a new part
  SearchPartWriter(std::span<const SearchRecord> searches, std::int64_t step);

  /// Goes on with the stored parts of the video that end where the searches do.
  void Resume(std::span<const SearchPart> stored);

  /// @param left_out  a search of the whole frame was due, and was left out to keep a pace
  /// @param damaged   the time before the frame
  void Enter(std::int64_t frame, double time_s, bool left_out, const std::optional<DamagedTime>& damaged);

  /// Enters the frames after the last search as searched, up to one. No effect if it is not after the last one.
  void ExtendTo(std::int64_t frame, double time_s);
  /// Enters the end of the video as damaged.
  void EnterDamage(const DamagedTime& damaged);

  /// Adds the parts that have changed since the last call to a batch.
  void MoveTo(IndexBatch& batch);

 private:
  void Begin(SearchPartKind kind, std::int64_t frame, double time_s);
  /// What was changed is written; a new part begins with the next frame.
  void End();

  std::span<const SearchRecord> searches_;
  std::int64_t step_;
  std::vector<SearchPart> parts_;  ///< the present one, of each search; empty: none
  std::vector<SearchPart> ended_;  ///< to be written
  bool is_changed_ = false;        ///< parts_
  std::optional<double> left_out_s_;
};

}  // namespace victorious
