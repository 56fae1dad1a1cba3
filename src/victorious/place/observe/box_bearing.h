// A user box in the image: its bearing observation, and its expected box in another view.
//
// The bearing goes through the box centre. Its range, if the type has a known length L, is f kBoxLengthRatio L / s, for
// a focal length f (px) and the longer box side s (px).
//
// The offset of the box centre from the object centre is the same in all frames of a video. All bearings of one video
// therefore share one `recognition_id` and have a fully correlated error (types/bearing_observation.h): more frames do
// not shrink the covariance of the place below this common error.
#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core/types.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/place/observe/object_type.h"
#include "victorious/types/bearing_observation.h"
#include "victorious/types/camera_state.h"

namespace victorious {

/// Standard deviation of an object's centre over the longer side of its box: how the box was drawn, and background
/// within it. Chosen; box_place_test.cc shows that the ellipsoids of places made with it contain the truth.
inline constexpr double kBoxCentreFraction = 0.12;

/// Ratio of the longer side of a box to that of its object, because of foreshortening, and its relative standard
/// deviation. Chosen, not fitted.
inline constexpr double kBoxLengthRatio = 0.85;
inline constexpr double kBoxLengthRatioSigma = 0.25;

/// True if a side of the box lies within 1 px of the image border or beyond: the object may extend outside the frame.
[[nodiscard]] bool TouchesImageBorder(const Box& box, const cv::Size& image_size);

/// Bearing observation of the centre of a box. std::nullopt if the camera state is incomplete.
/// @param box             px; may leave the frame
/// @param image_size      of the frame, px
/// @param type            its length gives the range, unless the box touches the image border; may be null
/// @param recognition_id  shared by all observations of this video and box; 0: an independent observation
std::optional<BearingObservation> MakeBoxBearingObservation(const Box& box, const cv::Size& image_size,
                                                            const CameraState& camera, const ObjectType* type,
                                                            std::int64_t recognition_id);

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

}  // namespace victorious
