// Which frames a pass searches as a whole, and for which part of the models' views.
//
// While the camera stands still, a second search finds hardly more than the first. When the image moves, new objects
// come into view, and known ones are seen from another side: then the next search is due. Successive searches take
// different parts of the views (docs/adr/0018).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <opencv2/core/types.hpp>

#include "victorious/geometry/similarity.h"
#include "victorious/search/follow/follower.h"
#include "victorious/search/recognize/view_part.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Spacing of searches for a part of the models' views, as a fraction of that for all.
inline constexpr double kPartSpacing = 2.0 / 3;

/// The frames between two searches for a part of the views. @param interval  between two for all
[[nodiscard]] int PartInterval(int interval);

/// True if a frame is searched as a whole: one each `interval` frames, and those where tracks restart.
[[nodiscard]] bool IsFullSearchFrame(std::int64_t frame, int interval, const FollowOptions& options);

/// How much rarer than at 1280 x 720 pixels frames are searched: the ratio of their pixels, 1 to 3. The time of a
/// search grows with the pixels (docs/adr/0043-resolution-of-the-search.md).
/// @param searched  size of the image that is searched
[[nodiscard]] double SearchSpacing(const cv::Size& searched);

/// Not thread-safe. What it decides depends on the frames since tracks last restarted, and on no earlier one.
class FullSearchSchedule {
 public:
  /// @param interval   frames between two searches at least (SearchIntervals)
  /// @param by_motion  false: every frame that IsFullSearchFrame names is due, for all views; true: if the interval has
  ///                   several frames, searches for a part of the views come at two thirds of it
  FullSearchSchedule(int interval, const FollowOptions& follow, bool by_motion);

  /// False if Enter cannot be true of a frame of this number.
  [[nodiscard]] bool MayBeSearched(std::int64_t index) const { return IsFullSearchFrame(index, interval_, follow_); }

  /// Call for each tracked frame, in order. True if it is one of those of IsFullSearchFrame, and tracks restart in it,
  /// or the image has moved by 3 % of its diagonal since the last search, or that is a second ago, or the motion is
  /// unknown; at two thirds of these for a part of the views.
  /// @param now_from_before  image motion since the frame before, px; std::nullopt: unknown
  /// @param spacing          these intervals of frames, motion and time are longer by this factor (SearchSpacing)
  [[nodiscard]] bool Enter(const Frame& frame, const std::optional<Similarity2>& now_from_before, double spacing = 1);

  /// Call if the frame entered last is searched as a whole. Returns for which views: all in the first frame that is
  /// searched of a video, which may be the last; else the part whose turn it is. Restarts of tracks begin with each
  /// part in turn, so that none is left out where few searches lie between two of them.
  [[nodiscard]] ViewPart SetSearched(const Frame& frame, bool is_first);

 private:
  const FollowOptions& follow_;
  bool by_motion_;
  bool by_parts_;
  double spacing_;
  int interval_;
  std::size_t next_part_ = 0;
  double searched_time_s_ = 0;                    // of the last search
  std::int64_t searched_frame_ = 0;               // of the last search
  std::optional<Similarity2> now_from_searched_;  // std::nullopt: unknown, or none since tracks restarted
};

}  // namespace victorious
