// Where on Earth what a drawn box holds is: lines of sight to the box's middle, and how far off a thing of its type of
// that size in the picture stands.
//
// How a box was drawn, and what it holds beside the object, is alike in all frames: the lines of one video err together
// (types/sight.h), so that a thousand frames do not feign a small ellipse.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "victorious/base/options.h"
#include "victorious/geolocate/locate_options.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/ground.h"
#include "victorious/pipeline/object_options.h"
#include "victorious/pipeline/object_type.h"
#include "victorious/telemetry/camera_track.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/place.h"
#include "victorious/types/sight.h"

namespace victorious {

struct BoxPlaceOptions {
  double centre_share = 0.12;
  double visible_share = 0.85;
  double size_share = 0.25;
  double least_agreeing = 0.7;
  double stretch_s = 8;
  double gate_sigma = 4;
  LocateOptions locate = ObjectOptions::InVideo();

  void ListFields(FieldList& fields);
};

/// Whether it ends at the frame's edge: the object may go on beyond.
[[nodiscard]] bool EndsAtTheEdge(const Box& box, const cv::Size& image_size);

/// The sight of what a box holds.
/// @param box         px; may leave the frame
/// @param image_size  the frame's, px
/// @param type        its length tells the range, where the box does not end at the frame's edge; may be null
/// @param recognition of its video and box, not 0
/// Nothing where the camera's state is not complete.
std::optional<Sight> SightOfBox(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                const ObjectType* type, std::int64_t recognition, const BoxPlaceOptions& options);

/// What is known of how an object moves, beside its lines of sight.
enum class BoxMotion {
  kUnknown,  ///< as the lines say. They do not tell what drives along with a camera that flies straight from what
             ///< stands: it is taken to stand
  kStands,
  kMoves,  ///< over the ground, as the picture shows
};

/// Where a spot of the ground is to be seen in a frame.
struct SpotSighting {
  std::int64_t frame = 0;
  double time_s = 0;
  Eigen::Vector2d place;  ///< px
};

/// Where a spot of the ground is, by its lines of sight; nothing where they do not tell it.
/// @param spots  of one spot, each in another frame, in order of time
std::optional<Place> PlaceOfSpot(std::span<const SpotSighting> spots, const CameraTrack& cameras,
                                 const cv::Size& image_size, const BoxPlaceOptions& options);

/// The ground that an object is on.
struct BoxGround {
  std::shared_ptr<const Ground> ground;  ///< not null
  double sigma_m = 0;                    ///< of its height

  /// As high as a place of it nearby.
  static BoxGround About(const Place& place);
};

/// Where it is at the time of each sight. What stands still is placed by all sights together, drawn to the ground if
/// that is told and may be where they meet. What is told to move, and what the lines show to do neither that nor drive
/// straight, is where each line of sight meets the ground. Without one, and where the lines alone show that it moves,
/// it is placed by stretches of at most `stretch_s`, in each as if it drove straight, and where they do not tell that
/// either, by each sight alone: where it meets the ground, or by its range.
/// @param sights  of one object in one video, in order of time
/// @param ground  for what is on the ground
/// @return one a sight, at its time; nothing where the lines do not tell it
std::vector<std::optional<Place>> PlacesOf(std::span<const Sight> sights, BoxMotion motion,
                                           const std::optional<BoxGround>& ground, const BoxPlaceOptions& options);

/// Where in a frame what stands at a place is to be seen, and how large it is there, by how it was seen once before.
struct SeenBox {
  Box box;
  double turn_rad = 0;  ///< of the ground in the picture since then, from +x towards +y
};

/// @param before, camera_before  how it was seen, and from where
/// @param camera                  from where it is looked for
/// Nothing where it is not before the camera, or a camera's state is not complete.
std::optional<SeenBox> ExpectBox(const GeodeticPoint& place, const Box& before, const CameraState& camera_before,
                                 const CameraState& camera, const cv::Size& image_size);

/// Whether a line of sight goes by a place, as near as their errors allow.
[[nodiscard]] bool GoesBy(const Sight& sight, const Place& place, const BoxPlaceOptions& options);

}  // namespace victorious
