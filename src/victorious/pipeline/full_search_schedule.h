// Which frames a pass searches as a whole, by how far the image has moved. What a camera sees from one place, a second
// search hardly finds better than the first; where it moves on, other objects come, and known ones are seen from
// another side.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/geometry/similarity.h"
#include "victorious/pipeline/index_options.h"
#include "victorious/types/frame.h"

namespace victorious {

/// Not thread-safe. What it decides depends on the frames since tracks last restarted, and on no earlier one.
class FullSearchSchedule {
 public:
  /// @param interval   frames between two searches at least (SearchIntervals)
  /// @param by_motion  false: every frame that IsFullSearchFrame names is due
  FullSearchSchedule(int interval, const FollowOptions& follow, bool by_motion)
      : interval_(interval), follow_(follow), by_motion_(by_motion) {}

  /// Call for each frame, in order. True if it is one of those of IsFullSearchFrame, and tracks restart in it, or the
  /// image has moved by 3 % of its diagonal since the last search, or that is a second ago, or the motion is unknown.
  /// @param now_from_before  image motion since the frame before, px; std::nullopt: unknown
  [[nodiscard]] bool Enter(const Frame& frame, const std::optional<Similarity2>& now_from_before);

  /// Call if the frame entered last is searched as a whole.
  void SetSearched(const Frame& frame);

 private:
  int interval_;
  const FollowOptions& follow_;
  bool by_motion_;
  double searched_time_s_ = 0;                    // of the last search
  std::optional<Similarity2> now_from_searched_;  // std::nullopt: unknown, or none since tracks restarted
};

}  // namespace victorious
