// Which landmarks a sighting may be of: those of its model. With telemetry, of many those near where it has what is
// seen: a list of thousands costs as much as those around the camera.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "victorious/navigate/landmark.h"
#include "victorious/navigate/navigate_options.h"
#include "victorious/navigate/smoother.h"

namespace victorious {

class Candidates {
 public:
  /// @param landmarks_of  by model; outlives this
  Candidates(const Flight& flight, std::span<const FlightLandmark> landmarks,
             std::span<const std::vector<std::size_t>> landmarks_of, std::span<const LandmarkSighting> sightings,
             const NavigateOptions& options);

  /// Of a sighting, rising.
  [[nodiscard]] std::span<const std::size_t> Of(std::size_t sighting) const {
    return near_[sighting].empty() ? std::span(landmarks_of_[model_of_[sighting]]) : std::span(near_[sighting]);
  }

 private:
  std::span<const std::vector<std::size_t>> landmarks_of_;
  std::vector<std::size_t> model_of_;           // one a sighting
  std::vector<std::vector<std::size_t>> near_;  // one a sighting; none: all of its model
};

}  // namespace victorious
