// Which sightings to believe, and of which landmark each is, before anything is estimated.
//
// A sighting, taken as one of a landmark, claims where the camera stands and how it is held. Telemetry (or the guess
// that the camera stays where it is) carries claims from frame to frame, at a growing loss. In each window of time the
// claim is sought that most landmarks agree with: a landmark counts by the logarithm of its sightings, so that one
// wrong landmark that is seen all the time does not outvote two right ones.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/navigate/candidates.h"
#include "victorious/navigate/landmark.h"
#include "victorious/navigate/navigate_options.h"
#include "victorious/navigate/smoother.h"

namespace victorious {

/// Where a camera stands, in the flight's tangent plane, with the covariance of (turn about the plane's axes, move).
struct PoseClaim {
  Eigen::Quaterniond camera_from_enu;
  Eigen::Vector3d place;
  Matrix6 covariance;
};

/// From a sighting, if it is of this landmark.
PoseClaim ClaimOf(const LandmarkSighting& sighting, const FlightLandmark& landmark);

/// @param sightings  by frame
/// @param wrong      one a landmark: those that no sighting is taken to be of
/// @return one a sighting: the landmark that it is taken to be; none where it agrees with too little
std::vector<std::optional<std::size_t>> FindAgreement(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                                      std::span<const LandmarkSighting> sightings,
                                                      const Candidates& candidates, const std::vector<bool>& wrong,
                                                      const NavigateOptions& options);

/// A state a frame, near the truth where sightings are near: what they claim, carried on by telemetry, or between them
/// in a straight line.
std::vector<FlightState> StartOf(const Flight& flight, std::span<const FlightLandmark> landmarks,
                                 std::span<const LandmarkSighting> sightings,
                                 std::span<const std::optional<std::size_t>> landmark_of);

}  // namespace victorious
