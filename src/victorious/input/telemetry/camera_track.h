// telemetry/: the camera trajectory. Interpolates the recorded camera states to any time of the video: position
// linearly, attitude by slerp.
#pragma once

#include <optional>
#include <vector>

#include "victorious/types/camera_state.h"

namespace victorious {

class CameraTrajectory {
 public:
  /// @param states     in any order; of those with equal times only the first is used
  /// @param max_gap_s  no interpolation between states further apart, s
  CameraTrajectory(std::vector<CameraState> states, double max_gap_s);

  /// @return the interpolated state; std::nullopt in a gap, between states of different vertical datum, and more than
  ///   0.1 s beyond the ends. An optional field that either neighbour lacks is empty.
  [[nodiscard]] std::optional<CameraState> At(double time_s) const;

  [[nodiscard]] const std::vector<CameraState>& states() const { return states_; }

 private:
  std::vector<CameraState> states_;  ///< by increasing time
  double max_gap_s_;
};

}  // namespace victorious
