// Estimates the place and the heading of one object from its bearing observations (geolocate/).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/geolocate/locate.h"
#include "victorious/place/geolocate/motion_path.h"
#include "victorious/types/bearing_observation.h"

namespace victorious {

/// Each line of sight of a track gets a place, smoothed to a path, if the median standard deviation of their
/// ranges is at most this fraction: those of CAD models are, those of boxes and photos are not.
inline constexpr double kMaxPathRangeFraction = 0.1;

/// An object whose path has a larger median acceleration has no place: no vehicle changes its velocity so all the time.
inline constexpr double kMaxAcceleration_m_s2 = 6;

struct ObjectPlace {
  std::optional<Geolocation> place;  ///< at the time of the last observation
  /// Only of a moving object with accurate ranges: its place and velocity at its observations (motion_path.h). The last
  /// is `place`.
  std::vector<Geolocation> path;
  std::size_t path_size = 0;          ///< of `path`, also where an estimate is kept without it (fits.h)
  std::optional<double> heading_rad;  ///< clockwise from north, [0, 2 pi)
  double inlier_fraction = 0;         ///< fraction of observations that are inliers of the place
  double consistent_fraction = 0;  ///< fraction of observations that are inliers and agree in heading, less those that
                                   ///< the motion model fits by its degrees of freedom
  std::int64_t headings = 0;       ///< inliers with a heading
  std::int64_t contradicting_headings = 0;  ///< those of them that do not agree with the common, or the previous one
  std::optional<double> size_ratio;  ///< ratio of the distance by intersection to the range by apparent size (median):
                                     ///< above 1 the object appears too large for its distance. std::nullopt if an
                                     ///< observation has no range or the lines do not intersect
  double size_sigma = 0;             ///< of it, relative: SizeRatio::sigma, and of the focal length

  [[nodiscard]] bool HasPath() const { return path_size > 0; }
  [[nodiscard]] bool IsMoving() const { return place && (place->IsMoving() || HasPath()); }
};

/// Ratio of the distance by intersection to the range by apparent size, as ObjectPlace::size_ratio.
struct SizeRatio {
  double ratio = 1;
  double sigma = 0;     ///< relative standard deviation of the distance by intersection
  bool stands = false;  ///< the lines meet in one point; else in one that moves
};

/// Estimates place and heading. Telemetry's own standard deviations, where given, replace those of the parameters.
/// Errors common to a flight enter with `common_fraction` times their standard deviation: 1 for absolute places, less
/// for the comparison of places of one flight, where most of them cancel. The errors of clock and field of view
/// (flight_shift.h) enter at 1 only. The result has no place if the observations do not determine one.
/// @param observations  of one object, in order of time; may be empty
/// @param options       pass ValidateOptions: then there is no failure but that of a place
/// @param size_ratio    EstimateSizeRatio of the same observations and options, if it is known. Only for a
///                      `common_fraction` of kFlightErrorFraction
ObjectPlace EstimatePlace(std::span<const BearingObservation> observations, const ObjectOptions& options,
                          double common_fraction,
                          const std::optional<std::optional<SizeRatio>>& size_ratio = std::nullopt);

/// The ratio alone, of observations as for EstimatePlace. Errors common to a flight cancel for the most part.
std::optional<SizeRatio> EstimateSizeRatio(std::span<const BearingObservation> observations,
                                           const ObjectOptions& options);

/// Propagates a place to another time with its velocity; the covariance grows with that of the velocity. A static place
/// only gets the new time.
Geolocation PropagatePlace(const Geolocation& place, double time_s);

/// As PropagatePlace, but ce90_m and le90_m stay as they are: for comparisons, which do not use them.
Geolocation PredictPlace(const Geolocation& place, double time_s);

/// The place of an estimate that has one, at any time: from the nearest place of its path, if there is one, with the
/// error that turns and changes of speed may add until then. ce90_m and le90_m are not of that time.
/// @param estimate  with its path, if it has one
Geolocation PlaceAt(const ObjectPlace& estimate, double time_s);

/// Mahalanobis distance between an observation and a place: 2 degrees of freedom across the line of sight, and a third
/// along it if the observation has a range. The covariance is the sum of those of the place, of the observation and of
/// the flight's common errors, the latter with `common_fraction` times their standard deviation.
/// @param place    at the time of the observation
/// @param slack_m  additional standard deviation of the position along each axis
/// @return infinity for a place behind the camera
double MahalanobisDistance(const BearingObservation& observation, const Geolocation& place, double slack_m,
                           const LocateOptions& errors, double common_fraction);

/// sqrt(difference^T covariance^-1 difference)
[[nodiscard]] double Mahalanobis(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance);

/// The covariance of the difference of two places, beside their own: kMergeSlack_m of each.
[[nodiscard]] Eigen::Matrix3d MergeSlackCovariance();

/// Robust mean heading: the mean of the headings in the densest window of 40 degrees, in [0, 2 pi). std::nullopt
/// without headings.
std::optional<double> EstimateHeadingMode(std::span<const double> headings_rad);

}  // namespace victorious
