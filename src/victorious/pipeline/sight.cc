#include "victorious/pipeline/sight.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/pipeline/stance.h"

namespace victorious {

void SightOptions::ListFields(FieldList& fields) {
  fields.Add("least_sigma_px", least_sigma_px,
             {.min = 0,
              .max = 100,
              .unit = "px",
              .reason = "the middle of a photo's object is never known better than this: matched points err together"});
  fields.Add("photo_centre_share", photo_centre_share,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "sigma of a photo's object's middle over its size: another side of it has another middle"});
  fields.Add("photo_range_share", photo_range_share,
             {.min = 1e-3,
              .max = 10,
              .unit = "",
              .reason = "sigma over range, of a photo's object of known length: it is seen foreshortened"});
}

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// What a sight is made of, in the camera's frame.
struct Seen {
  Vector3d direction;  // of unit length
  double sigma_rad = 0;
  std::optional<double> range_m;
  double sigma_range_m = 0;
  std::optional<Vector3d> front;  // of the object
};

// By how it stands before the camera.
Seen SeenByStance(const Stance& stance) {
  const Rigid3& stands = stance.camera_from_object;
  return {.direction = stands.translation.normalized(),
          .sigma_rad = stance.sigma_sight_rad,
          .range_m = stance.distance_m,
          .sigma_range_m = stance.sigma_distance_m,
          .front = stands.rotation * Vector3d::UnitX()};
}

// Of a photo: by its outline.
std::optional<Seen> SeenByOutline(const Detection& detection, const ObjectModel& model, const ImagePlane& image,
                                  const SightOptions& options) {
  const Polygon& outline = model.views[detection.view].outline;
  if (outline.size() < 3) return std::nullopt;
  const Box box = BoundingBox(outline);
  const Vector2d middle =
      ApplyHomography(detection.pose.scene_from_template_plane, {box.x + box.width / 2, box.y + box.height / 2});
  const double size_px = detection.pose.scene_from_template.scale * std::max(box.width, box.height);
  if (!middle.allFinite() || !(size_px > 0)) return std::nullopt;
  Seen seen{.direction = image.DirectionOf(middle),
            .sigma_rad = std::hypot(options.photo_centre_share * size_px, options.least_sigma_px) / image.focal_px()};
  if (model.length_m) {
    seen.range_m = image.focal_px() * *model.length_m / size_px;
    seen.sigma_range_m = options.photo_range_share * *seen.range_m;
  }
  return seen;
}

// Clockwise from north, [0, 2 pi); nothing for what points up or down.
std::optional<double> BearingOf(const Vector3d& direction_enu) {
  constexpr double kLeastHorizontal = 0.1;
  if (direction_enu.head<2>().norm() < kLeastHorizontal) return std::nullopt;
  const double bearing = std::atan2(direction_enu.x(), direction_enu.y());
  return bearing < 0 ? bearing + 2 * kPi : bearing;
}

}  // namespace

std::optional<Sight> SightOf(const Detection& detection, const std::optional<Stance>& stance, const ObjectModel& model,
                             const FeatureSet& scene, const CameraState& camera, const SightOptions& options) {
  if (!camera.IsComplete()) return std::nullopt;
  std::optional<Seen> seen;
  if (stance) {
    seen = SeenByStance(*stance);
  } else if (model.kind != "cad") {
    seen = SeenByOutline(detection, model, ImagePlane(scene, *camera.hfov_rad, camera.distortion), options);
  }
  if (!seen) return std::nullopt;
  const Quaterniond enu_from_camera = CameraFromEnu(*camera.attitude).conjugate();
  const Vector3d direction = enu_from_camera * seen->direction;
  Sight sight{.line = {.time_s = camera.time_s,
                       .camera = camera.place,
                       .azimuth_rad = std::atan2(direction.x(), direction.y()),
                       .elevation_rad = std::asin(std::clamp(direction.z(), -1.0, 1.0)),
                       .range_m = seen->range_m,
                       .sigma_rad = seen->sigma_rad},
              .heading_rad = std::nullopt,
              .sigma_position_m = camera.sigma_position_m,
              .sigma_attitude_rad = camera.sigma_attitude_rad};
  if (seen->range_m) sight.line.sigma_range_m = seen->sigma_range_m;
  if (seen->front) sight.heading_rad = BearingOf(enu_from_camera * *seen->front);
  return sight;
}

}  // namespace victorious
