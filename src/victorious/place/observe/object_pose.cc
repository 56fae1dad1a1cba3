#include "victorious/place/observe/object_pose.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/lens.h"
#include "victorious/geometry/view_direction.h"

namespace victorious {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Field of view where that of the camera is unknown (ADR 0012): it scales the distance, but hardly affects the
// rotation, because the object is small in the image.
constexpr double kAssumedFov_rad = 0.5;

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

// Smallest rotation that takes the optical axis to a direction.
Quaterniond RotationTowards(const Vector3d& direction) {
  return Quaterniond::FromTwoVectors(Vector3d::UnitZ(), direction);
}

// Clockwise image rotation of the object relative to the rendered view of a direction.
double InPlaneRotation(const Rigid3& camera_from_object, const ViewDirection& direction) {
  const Quaterniond turn = RotationTowards(camera_from_object.translation.normalized()).conjugate() *
                           camera_from_object.rotation * CameraFromModel(direction).conjugate();
  return WrapAngle(2 * std::atan2(turn.z(), turn.w()));
}

// Initial rotation: that of the matched view, at its position and in-plane rotation in the image.
Quaterniond InitialRotation(const Detection& detection, const ModelView& view, const ImagePlane& image) {
  const Vector2d image_middle(view.width / 2.0, view.height / 2.0);
  const Vector3d towards = image.DirectionOf(detection.fit.scene_from_template.Apply(image_middle));
  return RotationTowards(towards) *
         Eigen::AngleAxisd(detection.fit.scene_from_template.rotation_rad, Vector3d::UnitZ()) *
         CameraFromModel(*view.angles);
}

// Models with 3D points: 6-DoF fit.
std::optional<ObjectPose> EstimatePoseFromPoints(const Detection& detection, const ObjectModel& model,
                                                 const FeatureSet& scene, const ImagePlane& image,
                                                 const ObservationOptions& options,
                                                 const std::optional<Vector3d>& up_in_camera) {
  const ModelView& view = model.views[detection.view];
  if (!model.box_m || !view.angles) return std::nullopt;
  const Vector3d middle = model.box_m->center();
  std::vector<PointObservation> points;
  for (const FitInlier& inlier : detection.fit.inliers) {
    if (!inlier.point_in_model) continue;
    const Keypoint& keypoint = scene.keypoints[inlier.scene_keypoint];
    const Vector3d place(inlier.point_in_model->x, inlier.point_in_model->y, inlier.point_in_model->z);
    points.push_back({place - middle, image.At({keypoint.x, keypoint.y})});
  }
  if (points.empty()) return std::nullopt;
  const auto fit = FitObjectPose(points, InitialRotation(detection, view, image),
                                 {.sigma = options.point_sigma_px / image.focal_px(),
                                  .sigma_view_rad = RadiansFromDegrees(options.view_sigma_deg),
                                  .up_in_camera = up_in_camera,
                                  .sigma_up_rad = RadiansFromDegrees(kUpSigma_deg),
                                  .hypotheses = kPoseHypotheses});
  if (!fit) return std::nullopt;
  const Rigid3& camera_from_object = fit->camera_from_object;
  const ViewDirection seen_from =
      DirectionFromVector(camera_from_object.rotation.conjugate() * -camera_from_object.translation);
  const double range_m = camera_from_object.translation.norm();
  return ObjectPose{
      .direction = camera_from_object.translation / range_m,
      .sigma_rad = std::hypot(fit->sigma_angle_rad, options.min_sigma_px / image.focal_px()),
      .range_m = range_m,
      .sigma_range_m = std::hypot(fit->sigma_range_m, options.min_range_fraction * range_m),
      .camera_from_object = camera_from_object,
      .points = std::move(points),
      .focal_px = image.focal_px(),
      .view = ViewEstimate{.angles = seen_from,
                           .in_plane_rad = InPlaneRotation(camera_from_object, seen_from),
                           .sigma_rad = std::hypot(fit->sigma_view_rad, RadiansFromDegrees(kMinViewSigma_deg))}};
}

cv::Size ImageSize(const FeatureSet& scene) { return {scene.image_width, scene.image_height}; }

// Photos: direction and range from the outline.
std::optional<ObjectPose> EstimateBearingFromOutline(const Detection& detection, const ObjectModel& model,
                                                     const ImagePlane& image, const ObservationOptions& options) {
  const Polygon& outline = model.views[detection.view].outline;
  if (outline.size() < 3) return std::nullopt;
  const Box box = BoundingBox(outline);
  const Vector2d middle =
      ApplyHomography(detection.fit.scene_from_template_plane, {box.x + box.width / 2, box.y + box.height / 2});
  const double size_px = detection.fit.scene_from_template.scale * std::max(box.width, box.height);
  if (!middle.allFinite() || !(size_px > 0)) return std::nullopt;
  ObjectPose seen{.direction = image.DirectionOf(middle),
                  .sigma_rad = std::hypot(kPhotoCentreFraction * size_px, options.min_sigma_px) / image.focal_px(),
                  .range_m = std::nullopt,
                  .camera_from_object = std::nullopt,
                  .points = {},
                  .focal_px = image.focal_px(),
                  .view = std::nullopt};
  if (model.length_m) {
    seen.range_m = image.focal_px() * *model.length_m / size_px;
    seen.sigma_range_m = kPhotoRangeFraction * *seen.range_m;
  }
  return seen;
}

}  // namespace

std::optional<Vector3d> UpInCamera(const CameraState& camera) {
  if (!camera.attitude) return std::nullopt;
  return CameraFromEnu(*camera.attitude) * Vector3d::UnitZ();
}

std::optional<ObjectPose> EstimateObjectPose(const Detection& detection, const ObjectModel& model,
                                             const FeatureSet& scene, const CameraState& camera,
                                             const ObservationOptions& options,
                                             const std::optional<Vector3d>& up_in_camera) {
  if (camera.hfov_rad) {
    const ImagePlane image(ImageSize(scene), *camera.hfov_rad, camera.distortion);
    std::optional<ObjectPose> object_pose =
        EstimatePoseFromPoints(detection, model, scene, image, options, up_in_camera);
    if (!object_pose && model.kind != ModelKind::kCad)
      object_pose = EstimateBearingFromOutline(detection, model, image, options);
    return object_pose;
  }
  std::optional<ObjectPose> object_pose = EstimatePoseFromPoints(
      detection, model, scene, {ImageSize(scene), kAssumedFov_rad, std::nullopt}, options, up_in_camera);
  if (object_pose) object_pose->range_m.reset();
  return object_pose;
}

void AddTrackingDrift(ObjectPose& object_pose, int frames, const ObservationOptions& options) {
  object_pose.sigma_rad = std::hypot(object_pose.sigma_rad, frames * options.drift_px / object_pose.focal_px);
  if (object_pose.range_m) {
    object_pose.sigma_range_m =
        std::hypot(object_pose.sigma_range_m, frames * options.drift_range_fraction * *object_pose.range_m);
  }
}

std::optional<ObjectPose> EstimateBoxDirection(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                               double centre_fraction) {
  if (!camera.hfov_rad) return std::nullopt;
  const ImagePlane image(image_size, *camera.hfov_rad, camera.distortion);
  const double size_px = std::max(box.width, box.height);
  ObjectPose object_pose;
  object_pose.direction = image.DirectionOf({box.x + box.width / 2, box.y + box.height / 2});
  object_pose.sigma_rad = std::hypot(centre_fraction * size_px, kMinCentreSigma_px) / image.focal_px();
  object_pose.focal_px = image.focal_px();
  return object_pose;
}

}  // namespace victorious
