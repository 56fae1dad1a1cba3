// The candidate landmarks of each sighting for data association: those of its model. With telemetry and many landmarks,
// only those near the position predicted by telemetry, so that a list of thousands costs no more than those around the
// camera.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "victorious/place/navigate/landmark.h"
#include "victorious/place/navigate/navigate_options.h"
#include "victorious/place/navigate/smoother.h"

namespace victorious {

class Candidates {
 public:
  /// Computes the candidates of all sightings.
  /// @param landmarks_by_model  landmark indices by model; must outlive this object
  Candidates(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
             std::span<const std::vector<std::size_t>> landmarks_by_model, std::span<const LandmarkSighting> sightings,
             const NavigateOptions& options);

  /// The candidate landmarks of a sighting, in ascending order.
  [[nodiscard]] std::span<const std::size_t> LandmarksFor(std::size_t sighting) const {
    return nearby_[sighting].empty() ? std::span(landmarks_by_model_[sighting_models_[sighting]])
                                     : std::span(nearby_[sighting]);
  }

 private:
  std::span<const std::vector<std::size_t>> landmarks_by_model_;
  std::vector<std::size_t> sighting_models_;      // one per sighting
  std::vector<std::vector<std::size_t>> nearby_;  // one per sighting; empty: all of its model
};

}  // namespace victorious
