// Geolocation of user boxes: the bearing observations of a box (place/observe/box_bearing.h), the ground and the size
// of the object's type give the place of its object.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/options.h"
#include "victorious/geometry/ground.h"
#include "victorious/input/telemetry/camera_track.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/place/geolocate/locate_options.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/geolocation.h"

namespace victorious {

/// Minimum fraction of the lines of sight of a box that must be inliers of its place: if fewer are, the track has
/// drifted to something else. Chosen above ObjectOptions::min_inlier_fraction, because all lines are of one track.
inline constexpr double kMinBoxInlierFraction = 0.7;

struct BoxPlaceOptions {
  double max_interval_s = 8;
  double gate_sigma = 4;
  LocateOptions locate = ObjectOptions::SingleVideoDefaults();

  void ListFields(FieldList& fields);
};

/// Prior knowledge about the motion of an object.
enum class BoxMotion {
  kUnknown,  ///< decided by the lines of sight. These cannot separate an object that drives along with a camera that
             ///< flies straight from a static one: it is taken as static
  kStatic,
  kMoving,  ///< moves over the ground, measured in the image
};

/// Image observation of a ground point in one frame.
struct GroundPointObservation {
  std::int64_t frame = 0;
  double time_s = 0;
  Eigen::Vector2d position_px;
};

/// Geolocates a static ground point by the intersection of its lines of sight. std::nullopt if too few of them agree.
/// @param ground_points  observations of one point, each in another frame, in order of time
std::optional<Geolocation> LocateGroundPoint(std::span<const GroundPointObservation> ground_points,
                                             const CameraTrajectory& cameras, const cv::Size& image_size,
                                             const BoxPlaceOptions& options);

/// The ground under an object, with its standard deviation.
struct ObjectGround {
  std::shared_ptr<const Ground> ground;  ///< not null
  double sigma_m = 0;                    ///< standard deviation of the height

  /// Flat ground at the height of a nearby ground point.
  static ObjectGround AtPlace(const Geolocation& place);
};

/// Estimates the place of one object at the time of each observation:
/// - A static object gets one place from all observations, with the ground as a constraint if it is given and
///   compatible with the intersection.
/// - With a given ground, an object that moves (kMoving), or whose lines of sight fit neither a static point nor a
///   straight drive, is placed at the intersection of each line of sight with the ground.
/// - Without a ground, a moving object is placed in intervals of at most `max_interval_s` with constant velocity in
///   each. Where that fails, each observation is placed alone, by the ground or by its range.
/// @param observations  of one object in one video, in order of time
/// @param ground        for objects that stand on the ground, else std::nullopt
/// @return one place per observation, at its time; std::nullopt where the place is not determined
std::vector<std::optional<Geolocation>> EstimateBoxPlaces(std::span<const BearingObservation> observations,
                                                          BoxMotion motion, const std::optional<ObjectGround>& ground,
                                                          const BoxPlaceOptions& options);

/// True if the line of sight passes the place within `gate_sigma` (Mahalanobis distance of bearing, place and the
/// errors common to a flight).
[[nodiscard]] bool IsConsistentWithPlace(const BearingObservation& observation, const Geolocation& place,
                                         const BoxPlaceOptions& options);

}  // namespace victorious
