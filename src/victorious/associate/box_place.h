// Geolocation of user boxes: a box and the camera state give a bearing observation of the box centre; bearings, the
// ground and the size of the object's type give its place.
//
// The bearing goes through the box centre. Its range, if the type has a known length L, is f length_ratio L / s, for a
// focal length f (px) and the longer box side s (px).
//
// The offset of the box centre from the object centre is the same in all frames of a video. All bearings of one video
// therefore share one `recognition` id and have a fully correlated error (types/bearing_observation.h): more frames do
// not shrink the covariance of the place below this common error.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/associate/object_options.h"
#include "victorious/base/options.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/ground.h"
#include "victorious/observe/object_type.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/geolocation.h"

namespace victorious {

struct BoxPlaceOptions {
  double centre_fraction = 0.12;
  double length_ratio = 0.85;
  double size_fraction = 0.25;
  double min_inlier_fraction = 0.7;
  double max_interval_s = 8;
  double gate_sigma = 4;
  LocateOptions locate = ObjectOptions::SingleVideoDefaults();

  void ListFields(FieldList& fields);
};

/// True if a side of the box lies within 1 px of the image border or beyond: the object may extend outside the frame.
[[nodiscard]] bool TouchesImageBorder(const Box& box, const cv::Size& image_size);

/// Bearing observation of the centre of a box. std::nullopt if the camera state is incomplete.
/// @param box          px; may leave the frame
/// @param image_size   of the frame, px
/// @param type         its length gives the range, unless the box touches the image border; may be null
/// @param recognition  id shared by all observations of this video and box, not 0
std::optional<BearingObservation> MakeBoxBearingObservation(const Box& box, const cv::Size& image_size,
                                                            const CameraState& camera, const ObjectType* type,
                                                            std::int64_t recognition_id,
                                                            const BoxPlaceOptions& options);

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
  Eigen::Vector2d place;  ///< px
};

/// Geolocates a static ground point by the intersection of its lines of sight. std::nullopt if too few of them agree.
/// @param spots  observations of one point, each in another frame, in order of time
std::optional<Geolocation> LocateGroundPoint(std::span<const GroundPointObservation> spots,
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
/// each.
///   Where that fails, each observation is placed alone, by the ground or by its range.
/// @param sights  of one object in one video, in order of time
/// @param ground  for objects that stand on the ground, else std::nullopt
/// @return one place per observation, at its time; std::nullopt where the place is not determined
std::vector<std::optional<Geolocation>> EstimateBoxPlaces(std::span<const BearingObservation> observations,
                                                          BoxMotion motion, const std::optional<ObjectGround>& ground,
                                                          const BoxPlaceOptions& options);

/// Predicted image box of a static object.
struct PredictedBox {
  Box box;
  double turn_rad = 0;  ///< clockwise in-plane rotation of the ground since the earlier view
};

/// Predicts the box of a static object in another view: centre by projection, size by the ratio of ground sampling
/// distances, rotation by the projected north direction. std::nullopt if the place is behind a camera, or a camera
/// state is incomplete.
/// @param before, camera_before  box and camera state of the earlier view
/// @param camera                 camera state of the new view
std::optional<PredictedBox> PredictBox(const GeodeticPoint& place, const Box& before, const CameraState& camera_before,
                                       const CameraState& camera, const cv::Size& image_size);

/// True if the line of sight passes the place within `gate_sigma` (Mahalanobis distance of bearing, place and the
/// errors common to a flight).
[[nodiscard]] bool IsConsistentWithPlace(const BearingObservation& observation, const Geolocation& place,
                                         const BoxPlaceOptions& options);

}  // namespace victorious
