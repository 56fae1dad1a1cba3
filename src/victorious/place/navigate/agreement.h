// Initial data association for landmark navigation: which sightings are inliers, and of which landmark each is, before
// any estimation; and the initial states for the smoother.
//
// A sighting together with a landmark yields a hypothesis of the camera pose. Telemetry, or else the assumption that
// the camera stays in place, transfers hypotheses from frame to frame with growing variance. In each time window the
// hypothesis supported by the most landmarks wins; a landmark counts by the logarithm of its number of sightings, so
// that one wrong landmark that is always in view does not outvote two correct ones.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "victorious/place/navigate/candidates.h"
#include "victorious/place/navigate/landmark.h"
#include "victorious/place/navigate/smoother.h"

namespace victorious {

/// Maximum position standard deviation of a camera pose hypothesis from one sighting, m: less accurate ones do not vote
/// in the initial association, and are not associated later. Chosen; at 120 m it is a rotation of 7 degrees.
inline constexpr double kMaxHypothesisSigma_m = 15;

/// A hypothesis of the camera pose in the flight's tangent plane, with the covariance of (rotation about the plane's
/// axes, translation).
struct PoseHypothesis {
  Eigen::Quaterniond camera_from_enu;
  Eigen::Vector3d place;
  Matrix6 covariance;
};

/// The camera pose that follows from a sighting, if it is of this landmark.
PoseHypothesis PoseFromSighting(const LandmarkSighting& sighting, const FlightLandmark& landmark);

/// Associates sightings with landmarks by consensus of their pose hypotheses.
/// @param sightings  ordered by frame
/// @param wrong      one per landmark: true for landmarks that are excluded from the association
/// @return one per sighting: index of the landmark; std::nullopt for an outlier
std::vector<std::optional<std::size_t>> FindConsensusAssociation(const FlightInput& flight,
                                                                 std::span<const FlightLandmark> landmarks,
                                                                 std::span<const LandmarkSighting> sightings,
                                                                 const Candidates& candidates,
                                                                 const std::vector<bool>& wrong);

/// Initial states for the smoother, one per frame: from the associated sightings where there are any; else from
/// telemetry corrected by the offset at the nearest such frame, or without telemetry interpolated linearly between
/// them.
std::vector<FlightState> EstimateInitialStates(const FlightInput& flight, std::span<const FlightLandmark> landmarks,
                                               std::span<const LandmarkSighting> sightings,
                                               std::span<const std::optional<std::size_t>> landmark_by_sighting);

}  // namespace victorious
