#include "victorious/pipeline/stance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "victorious/geolocate/object_pose.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/render/view_sphere.h"

namespace victorious {

void StanceOptions::ListFields(FieldList& fields) {
  fields.Add("point_sigma_px", point_sigma_px,
             {.min = 1e-3, .max = 100, .unit = "px", .reason = "sigma of a matched keypoint's place in the frame"});
  fields.Add("view_sigma_deg", view_sigma_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "how far the direction of sight is from that of the view that matched: views stand 10 degrees "
                        "apart"});
  fields.Add("up_sigma_deg", up_sigma_deg,
             {.min = 1e-3,
              .max = 180,
              .unit = "deg",
              .reason = "how far an object's up leans from the vertical, where telemetry tells that; 180 lets objects "
                        "lie as they like"});
  fields.Add("least_view_sigma_deg", least_view_sigma_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "the direction of sight is never known better than this: matched points err together"});
  fields.Add("least_sigma_px", least_sigma_px,
             {.min = 0,
              .max = 100,
              .unit = "px",
              .reason = "the middle of an object is never known better than this: for the same reason"});
  fields.Add("least_distance_share", least_distance_share,
             {.min = 0, .max = 1, .reason = "sigma over distance, at least: for the same reason"});
  fields.Add("hypotheses", hypotheses,
             {.min = 0, .max = 10000, .reason = "poses of three points tried, at most; 0 trusts every matched point"});
}

ImagePlane::ImagePlane(const FeatureSet& scene, double hfov_rad, const std::optional<LensDistortion>& lens)
    : focal_px_(scene.image_width / 2.0 / std::tan(hfov_rad / 2)),
      middle_(scene.image_width / 2.0, scene.image_height / 2.0),
      lens_(lens.value_or(LensDistortion{})) {}

Eigen::Vector2d ImagePlane::At(const Eigen::Vector2d& pixel) const {
  return Undistort((pixel - middle_) / focal_px_, lens_);
}

Eigen::Vector3d ImagePlane::DirectionOf(const Eigen::Vector2d& pixel) const {
  return At(pixel).homogeneous().normalized();
}

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

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

// A camera that looks along the optical axis, turned the shortest way to look in another direction.
Quaterniond Towards(const Vector3d& direction) { return Quaterniond::FromTwoVectors(Vector3d::UnitZ(), direction); }

// How far a view from a direction is turned in the image, clockwise.
double TurnOf(const Rigid3& camera_from_object, const ViewDirection& direction) {
  const Quaterniond turn = Towards(camera_from_object.translation.normalized()).conjugate() *
                           camera_from_object.rotation * CameraFromModel(direction).conjugate();
  return WrapAngle(2 * std::atan2(turn.z(), turn.w()));
}

// How the view that matched is turned before the camera, as it lies in the picture.
Quaterniond RotationOfView(const Detection& detection, const ModelView& view, const ImagePlane& image) {
  const Vector2d picture_middle(view.width / 2.0, view.height / 2.0);
  const Vector3d towards = image.DirectionOf(detection.pose.scene_from_template.Apply(picture_middle));
  return Towards(towards) * Eigen::AngleAxisd(detection.pose.scene_from_template.rotation_rad, Vector3d::UnitZ()) *
         CameraFromModel({view.angles->azimuth_rad, view.angles->off_nadir_rad});
}

}  // namespace

std::optional<Stance> StanceOf(const Detection& detection, const ObjectModel& model, const FeatureSet& scene,
                               const std::optional<CameraState>& camera, const StanceOptions& options) {
  // A supposed field of view puts the object too far or too near, and hardly turns it: it is small before the camera.
  constexpr double kSupposedFovRad = 0.5;
  const bool knows_scale = camera && camera->hfov_rad;
  const ImagePlane image(scene, knows_scale ? *camera->hfov_rad : kSupposedFovRad,
                         knows_scale ? camera->distortion : std::nullopt);
  const ModelView& view = model.views[detection.view];
  const std::vector<Vector3d> places = PlacesOf(detection, model);
  if (places.empty() || !model.box_m || !view.angles) return std::nullopt;
  const Vector3d middle = model.box_m->center();
  std::vector<SeenPoint> points;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Keypoint& keypoint = scene.keypoints[detection.pose.inliers[i].scene];
    points.push_back({places[i] - middle, image.At({keypoint.x, keypoint.y})});
  }
  ObjectPoseOptions fit{.sigma = options.point_sigma_px / image.focal_px(),
                        .sigma_view_rad = RadiansFromDegrees(options.view_sigma_deg),
                        .sigma_up_rad = RadiansFromDegrees(options.up_sigma_deg),
                        .hypotheses = options.hypotheses};
  if (knows_scale && camera->attitude) fit.up_in_camera = CameraFromEnu(*camera->attitude) * Vector3d::UnitZ();
  const auto pose = FitObjectPose(points, RotationOfView(detection, view, image), fit);
  if (!pose) return std::nullopt;
  const Rigid3& stands = pose->camera_from_object;
  const ViewDirection direction = DirectionFromVector(stands.rotation.conjugate() * -stands.translation);
  const double distance_m = stands.translation.norm();
  Stance stance{
      .camera_from_object = stands,
      .view = {direction.azimuth_rad, direction.off_nadir_rad},
      .in_plane_rad = TurnOf(stands, direction),
      .sigma_view_rad = std::hypot(pose->sigma_view_rad, RadiansFromDegrees(options.least_view_sigma_deg)),
      .sigma_sight_rad = std::hypot(pose->sigma_angle_rad, options.least_sigma_px / image.focal_px()),
  };
  if (knows_scale) {
    stance.distance_m = distance_m;
    stance.sigma_distance_m = std::hypot(pose->sigma_range_m, options.least_distance_share * distance_m);
  }
  return stance;
}

}  // namespace victorious
