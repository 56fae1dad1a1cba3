#include "victorious/observe/object_pose.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/lens.h"
#include "victorious/geometry/view_sphere.h"

namespace victorious {

void SightOptions::ListFields(FieldList& fields) {
  fields.Add("point_sigma_px", point_sigma_px,
             {.min = 1e-3,
              .max = 100,
              .unit = "px",
              .reason = "standard deviation of a matched keypoint's position in the frame"});
  fields.Add(
      "view_sigma_deg", view_sigma_deg,
      {.min = 1e-3,
       .max = 180,
       .unit = "deg",
       .reason =
           "standard deviation of the direction of view from that of the matched view: views are 10 degrees apart"});
  fields.Add("up_sigma_deg", up_sigma_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "standard deviation of an object's up axis from the vertical, if telemetry gives the attitude; "
                        "180 allows any orientation"});
  fields.Add(
      "least_view_sigma_deg", least_view_sigma_deg,
      {.min = 0,
       .max = 180,
       .unit = "deg",
       .reason = "minimum standard deviation of the direction of view: errors of matched points are correlated"});
  fields.Add("least_sigma_px", least_sigma_px,
             {.min = 0,
              .max = 100,
              .unit = "px",
              .reason = "minimum standard deviation of an object's centre, for the same reason"});
  fields.Add("least_range_share", least_range_share,
             {.min = 0, .max = 1, .reason = "minimum relative standard deviation of the range, for the same reason"});
  fields.Add("hypotheses", hypotheses,
             {.min = 0,
              .max = 10000,
              .reason = "maximum number of three-point pose hypotheses; 0 takes every match as an inlier"});
  fields.Add(
      "photo_centre_share", photo_centre_share,
      {.min = 0,
       .max = 1,
       .unit = "",
       .reason = "standard deviation of a photo object's centre over its size: another side has another centre"});
  fields.Add(
      "photo_range_share", photo_range_share,
      {.min = 1e-3,
       .max = 10,
       .unit = "",
       .reason =
           "relative standard deviation of the range of a photo object of known length, because of foreshortening"});
  fields.Add("drift_px", drift_px,
             {.min = 0,
              .max = 100,
              .unit = "px",
              .reason = "standard deviation of an object's centre added by each frame in which it is only tracked"});
  fields.Add(
      "drift_range_share", drift_range_share,
      {.min = 0, .max = 1, .unit = "", .reason = "relative standard deviation of the range added by each such frame"});
  fields.Add("category_centre_share", category_centre_share,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "standard deviation of the centre of a category's object over the longer side of its box"});
}

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Normalised image plane (z = 1) with the lens undistorted; square pixels, principal point at the image centre.
class ImagePlane {
 public:
  ImagePlane(const cv::Size& image, double hfov_rad, const std::optional<LensDistortion>& lens)
      : focal_px_(FocalLengthPx(hfov_rad, image.width)),
        middle_(image.width / 2.0, image.height / 2.0),
        lens_(lens.value_or(LensDistortion{})) {}

  [[nodiscard]] double focal_px() const { return focal_px_; }
  [[nodiscard]] Vector2d At(const Vector2d& pixel) const { return Undistort((pixel - middle_) / focal_px_, lens_); }
  [[nodiscard]] Vector3d DirectionOf(const Vector2d& pixel) const { return At(pixel).homogeneous().normalized(); }

 private:
  double focal_px_;
  Vector2d middle_;
  LensDistortion lens_;
};

// 3D points of the matches in the model's frame, m.
std::vector<Vector3d> PlacesOf(const Detection& detection, const ObjectModel& model) {
  std::vector<Vector3d> places;
  const auto add = [&](const Point3& point) { places.emplace_back(point.x, point.y, point.z); };
  std::ranges::for_each(detection.pose.inlier_points, add);
  if (!places.empty() || model.points_in_model.empty()) return places;
  const std::size_t first = model.views[detection.view].first_feature;
  for (const Match& match : detection.pose.inliers) add(model.points_in_model[first + match.model]);
  return places;
}

// Smallest rotation that takes the optical axis to a direction.
Quaterniond Towards(const Vector3d& direction) { return Quaterniond::FromTwoVectors(Vector3d::UnitZ(), direction); }

// Clockwise image rotation of the object relative to the rendered view of a direction.
double TurnOf(const Rigid3& camera_from_object, const ViewDirection& direction) {
  const Quaterniond turn = Towards(camera_from_object.translation.normalized()).conjugate() *
                           camera_from_object.rotation * CameraFromModel(direction).conjugate();
  return WrapAngle(2 * std::atan2(turn.z(), turn.w()));
}

// Initial rotation: that of the matched view, at its position and in-plane rotation in the image.
Quaterniond RotationOfView(const Detection& detection, const ModelView& view, const ImagePlane& image) {
  const Vector2d picture_middle(view.width / 2.0, view.height / 2.0);
  const Vector3d towards = image.DirectionOf(detection.pose.scene_from_template.Apply(picture_middle));
  return Towards(towards) * Eigen::AngleAxisd(detection.pose.scene_from_template.rotation_rad, Vector3d::UnitZ()) *
         CameraFromModel({view.angles->azimuth_rad, view.angles->off_nadir_rad});
}

// Models with 3D points: 6-DoF fit.
std::optional<Stance> SeenByPoints(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                                   const ImagePlane& image, const SightOptions& options,
                                   const std::optional<Vector3d>& up_in_camera) {
  const ModelView& view = model.views[detection.view];
  const std::vector<Vector3d> places = PlacesOf(detection, model);
  if (places.empty() || !model.box_m || !view.angles) return std::nullopt;
  const Vector3d middle = model.box_m->center();
  std::vector<SeenPoint> points;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Keypoint& keypoint = scene.keypoints[detection.pose.inliers[i].scene];
    points.push_back({places[i] - middle, image.At({keypoint.x, keypoint.y})});
  }
  const auto pose = FitObjectPose(points, RotationOfView(detection, view, image),
                                  {.sigma = options.point_sigma_px / image.focal_px(),
                                   .sigma_view_rad = RadiansFromDegrees(options.view_sigma_deg),
                                   .up_in_camera = up_in_camera,
                                   .sigma_up_rad = RadiansFromDegrees(options.up_sigma_deg),
                                   .hypotheses = options.hypotheses});
  if (!pose) return std::nullopt;
  const Rigid3& stands = pose->camera_from_object;
  const ViewDirection seen_from = DirectionFromVector(stands.rotation.conjugate() * -stands.translation);
  const double range_m = stands.translation.norm();
  return Stance{.direction = stands.translation / range_m,
                .sigma_rad = std::hypot(pose->sigma_angle_rad, options.least_sigma_px / image.focal_px()),
                .range_m = range_m,
                .sigma_range_m = std::hypot(pose->sigma_range_m, options.least_range_share * range_m),
                .camera_from_object = stands,
                .points = std::move(points),
                .focal_px = image.focal_px(),
                .view = SeenView{
                    .angles = {seen_from.azimuth_rad, seen_from.off_nadir_rad},
                    .in_plane_rad = TurnOf(stands, seen_from),
                    .sigma_rad = std::hypot(pose->sigma_view_rad, RadiansFromDegrees(options.least_view_sigma_deg))}};
}

cv::Size SizeOf(const FeatureSet& scene) { return {scene.image_width, scene.image_height}; }

// Photos: direction and range from the outline.
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
              .range_m = std::nullopt,
              .camera_from_object = std::nullopt,
              .points = {},
              .focal_px = image.focal_px(),
              .view = std::nullopt};
  if (model.length_m) {
    seen.range_m = image.focal_px() * *model.length_m / size_px;
    seen.sigma_range_m = options.photo_range_share * *seen.range_m;
  }
  return seen;
}

}  // namespace

std::optional<Vector3d> UpInCamera(const CameraState& camera) {
  if (!camera.attitude) return std::nullopt;
  return CameraFromEnu(*camera.attitude) * Vector3d::UnitZ();
}

std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const CameraState& camera, const SightOptions& options,
                               const std::optional<Vector3d>& up_in_camera) {
  if (camera.hfov_rad) {
    const ImagePlane image(SizeOf(scene), *camera.hfov_rad, camera.distortion);
    std::optional<Stance> stance = SeenByPoints(detection, model, scene, image, options, up_in_camera);
    if (!stance && model.kind != "cad") stance = SeenByOutline(detection, model, image, options);
    return stance;
  }
  // An assumed field of view scales the distance, but hardly affects the rotation: the object is small in the image.
  constexpr double kSupposedFovRad = 0.5;
  std::optional<Stance> stance =
      SeenByPoints(detection, model, scene, {SizeOf(scene), kSupposedFovRad, std::nullopt}, options, up_in_camera);
  if (stance) stance->range_m.reset();
  return stance;
}

void Age(Stance& stance, int frames, const SightOptions& options) {
  stance.sigma_rad = std::hypot(stance.sigma_rad, frames * options.drift_px / stance.focal_px);
  if (stance.range_m) {
    stance.sigma_range_m = std::hypot(stance.sigma_range_m, frames * options.drift_range_share * *stance.range_m);
  }
}

std::optional<Stance> StanceOfBox(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                  const SightOptions& options) {
  if (!camera.hfov_rad) return std::nullopt;
  const ImagePlane image(image_size, *camera.hfov_rad, camera.distortion);
  const double size_px = std::max(box.width, box.height);
  Stance stance;
  stance.direction = image.DirectionOf({box.x + box.width / 2, box.y + box.height / 2});
  stance.sigma_rad = std::hypot(options.category_centre_share * size_px, options.least_sigma_px) / image.focal_px();
  stance.focal_px = image.focal_px();
  return stance;
}

}  // namespace victorious
