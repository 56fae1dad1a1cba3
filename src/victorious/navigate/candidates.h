// The candidate landmarks of each sighting for data association: those of its model. With telemetry and many landmarks,
// only those near the position predicted by telemetry, so that a list of thousands costs no more than those around the
// camera.
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
  /// Computes the candidates of all sightings.
  /// @param landmarks_by_model  landmark indices by model; must outlive this object
  Candidates(const Flight& flight, std::span<const FlightLandmark> landmarks,
             std::span<const std::vector<std::size_t>> landmarks_of, std::span<const LandmarkSighting> sightings,
             const NavigateOptions& options);

  /// The candidate landmarks of a sighting, in ascending order.
  [[nodiscard]] std::span<const std::size_t> Of(std::size_t sighting) const {
    return near_[sighting].empty() ? std::span(landmarks_of_[model_of_[sighting]]) : std::span(near_[sighting]);
  }

 private:
  std::span<const std::vector<std::size_t>> landmarks_of_;
  std::vector<std::size_t> model_of_;           // one per sighting
  std::vector<std::vector<std::size_t>> near_;  // one per sighting; empty: all of its model
};

}  // namespace victorious
