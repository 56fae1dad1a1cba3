// The camera's state at any moment of a video, from those that telemetry recorded: place linear, attitude on the
// sphere.
#pragma once

#include <optional>
#include <vector>

#include "victorious/types/camera_state.h"

namespace victorious {

class CameraTrack {
 public:
  /// @param states     in any order; of those with the same time the first counts
  /// @param max_gap_s  between states further apart nothing is known
  CameraTrack(std::vector<CameraState> states, double max_gap_s);

  /// Nothing in a gap, and beyond the ends by more than a tenth of a second. What only one neighbour knows stays
  /// unknown.
  [[nodiscard]] std::optional<CameraState> At(double time_s) const;

  [[nodiscard]] const std::vector<CameraState>& states() const { return states_; }

 private:
  std::vector<CameraState> states_;  ///< by rising time
  double max_gap_s_;
};

}  // namespace victorious
