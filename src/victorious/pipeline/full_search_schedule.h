// Which frames a pass searches as a whole, by how far the image has moved, and for which part of the models' views.
// What a camera sees from one place, a second search hardly finds better than the first; where it moves on, other
// objects come, and known ones are seen from another side. Three searches for a third of the views each find more than
// two for all of them, in half the time (docs/adr/0018).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "victorious/geometry/similarity.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/recognize/view_part.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Not thread-safe. What it decides depends on the frames since tracks last restarted, and on no earlier one.
class FullSearchSchedule {
 public:
  /// @param interval   frames between two searches at least (SearchIntervals)
  /// @param by_motion  false: every frame that IsFullSearchFrame names is due, for all views; true: if the interval has
  ///                   several frames, searches for a part of the views come at two thirds of it
  FullSearchSchedule(int interval, const FollowOptions& follow, bool by_motion);

  /// Call for each frame, in order. True if it is one of those of IsFullSearchFrame, and tracks restart in it, or the
  /// image has moved by 3 % of its diagonal since the last search, or that is a second ago, or the motion is unknown;
  /// at two thirds of these for a part of the views.
  /// @param now_from_before  image motion since the frame before, px; std::nullopt: unknown
  [[nodiscard]] bool Enter(const Frame& frame, const std::optional<Similarity2>& now_from_before);

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
  std::optional<Similarity2> now_from_searched_;  // std::nullopt: unknown, or none since tracks restarted
};

}  // namespace victorious
