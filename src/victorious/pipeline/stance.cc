#include "victorious/pipeline/stance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/lens.h"
#include "victorious/render/view_sphere.h"

namespace victorious {

void SightOptions::ListFields(FieldList& fields) {
  fields.Add("point_sigma_px", point_sigma_px,
             {.min = 1e-3, .max = 100, .unit = "px", .reason = "sigma of a matched keypoint's place in the frame"});
  fields.Add("view_sigma_deg", view_sigma_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "how far the direction of sight is from that of the view that matched: views stand 10 degrees "
                        "apart"});
  fields.Add("least_sigma_px", least_sigma_px,
             {.min = 0,
              .max = 100,
              .unit = "px",
              .reason = "the middle of an object is never known better than this: matched points err together"});
  fields.Add("least_range_share", least_range_share,
             {.min = 0, .max = 1, .unit = "", .reason = "sigma over range, at least: for the same reason"});
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

// The picture's plane at depth 1, the lens undone.
class ImagePlane {
 public:
  ImagePlane(const FeatureSet& scene, const CameraState& camera)
      : focal_px_(scene.image_width / 2.0 / std::tan(*camera.hfov_rad / 2)),
        middle_(scene.image_width / 2.0, scene.image_height / 2.0),
        lens_(camera.distortion.value_or(LensDistortion{})) {}

  [[nodiscard]] double focal_px() const { return focal_px_; }
  [[nodiscard]] Vector2d At(const Vector2d& pixel) const { return Undistort((pixel - middle_) / focal_px_, lens_); }
  [[nodiscard]] Vector3d DirectionOf(const Vector2d& pixel) const { return At(pixel).homogeneous().normalized(); }

 private:
  double focal_px_;
  Vector2d middle_;
  LensDistortion lens_;
};

// The matched points' places on the object, m.
std::vector<Vector3d> PlacesOf(const Detection& detection, const ObjectModel& model) {
  std::vector<Vector3d> places;
  const auto add = [&](const Point3& point) { places.emplace_back(point.x, point.y, point.z); };
  std::ranges::for_each(detection.pose.inlier_points, add);
  if (!places.empty() || model.points_in_model.empty()) return places;
  const std::size_t first = model.views[detection.view].first_feature;
  for (const Match& match : detection.pose.inliers) add(model.points_in_model[first + match.model]);
  return places;
}

// Of a model that knows its points in space.
std::optional<Stance> SeenByPoints(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                                   const ImagePlane& image, const SightOptions& options) {
  const ModelView& view = model.views[detection.view];
  const std::vector<Vector3d> places = PlacesOf(detection, model);
  if (places.empty() || !model.box_m || !view.angles) return std::nullopt;
  const Vector3d middle = model.box_m->center();
  std::vector<SeenPoint> points;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Keypoint& keypoint = scene.keypoints[detection.pose.inliers[i].scene];
    points.push_back({places[i] - middle, image.At({keypoint.x, keypoint.y})});
  }
  const Vector2d picture_middle(view.width / 2.0, view.height / 2.0);
  const Vector3d towards = image.DirectionOf(detection.pose.scene_from_template.Apply(picture_middle));
  const Quaterniond start = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), towards) *
                            Eigen::AngleAxisd(detection.pose.scene_from_template.rotation_rad, Vector3d::UnitZ()) *
                            CameraFromModel({view.angles->azimuth_rad, view.angles->off_nadir_rad});
  const auto pose = FitObjectPose(points, start,
                                  {.sigma = options.point_sigma_px / image.focal_px(),
                                   .sigma_view_rad = RadiansFromDegrees(options.view_sigma_deg)});
  if (!pose) return std::nullopt;
  const double range_m = pose->camera_from_object.translation.norm();
  return Stance{.direction = pose->camera_from_object.translation / range_m,
                .sigma_rad = std::hypot(pose->sigma_angle_rad, options.least_sigma_px / image.focal_px()),
                .range_m = range_m,
                .sigma_range_m = std::hypot(pose->sigma_range_m, options.least_range_share * range_m),
                .camera_from_object = pose->camera_from_object,
                .points = std::move(points),
                .focal_px = image.focal_px()};
}

// Of a photo: by its outline.
std::optional<Stance> SeenByOutline(const Detection& detection, const ObjectModel& model, const ImagePlane& image,
                                    const SightOptions& options) {
  const Polygon& outline = model.views[detection.view].outline;
  if (outline.size() < 3) return std::nullopt;
  const Box box = BoundingBox(outline);
  const Vector2d middle =
      ApplyHomography(detection.pose.scene_from_template_plane, {box.x + box.width / 2, box.y + box.height / 2});
  const double size_px = detection.pose.scene_from_template.scale * std::max(box.width, box.height);
  if (!middle.allFinite() || !(size_px > 0)) return std::nullopt;
  Stance seen{.direction = image.DirectionOf(middle),
              .sigma_rad = std::hypot(options.photo_centre_share * size_px, options.least_sigma_px) / image.focal_px(),
              .focal_px = image.focal_px()};
  if (model.length_m) {
    seen.range_m = image.focal_px() * *model.length_m / size_px;
    seen.sigma_range_m = options.photo_range_share * *seen.range_m;
  }
  return seen;
}

}  // namespace

std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const CameraState& camera, const SightOptions& options) {
  if (!camera.hfov_rad) return std::nullopt;
  const ImagePlane image(scene, camera);
  std::optional<Stance> stance = SeenByPoints(detection, model, scene, image, options);
  if (!stance && model.kind != "cad") stance = SeenByOutline(detection, model, image, options);
  return stance;
}

}  // namespace victorious
