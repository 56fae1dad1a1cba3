#include "victorious/place/observe/box_bearing.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/lens.h"
#include "victorious/place/observe/bearing_observation.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Image point of a 3D point, px, and its ground sampling distance.
struct Projection {
  Vector2d pixel;
  double m_per_px = 0;
};

std::optional<Projection> Project(const GeodeticPoint& point, const CameraState& camera, const cv::Size& image) {
  const Vector3d in_camera = CameraFromEnu(*camera.attitude) * TangentPlane(camera.place).EnuFromGeodetic(point);
  if (!(in_camera.z() > 0)) return std::nullopt;
  const double focal_px = FocalLengthPx(*camera.hfov_rad, image.width);
  const Vector2d shown = Distort(in_camera.hnormalized(), camera.distortion.value_or(LensDistortion{}));
  return Projection{focal_px * shown + Vector2d(image.width / 2.0, image.height / 2.0), in_camera.z() / focal_px};
}

}  // namespace

bool TouchesImageBorder(const Box& box, const cv::Size& image) {
  constexpr double kMarginPx = 1;
  return box.x < kMarginPx || box.y < kMarginPx || box.x + box.width > image.width - kMarginPx ||
         box.y + box.height > image.height - kMarginPx;
}

std::optional<BearingObservation> MakeBoxBearingObservation(const Box& box, const cv::Size& image_size,
                                                            const CameraState& camera, const ObjectType* type,
                                                            std::int64_t recognition_id) {
  auto object_pose = EstimateBoxDirection(box, image_size, camera, kBoxCentreFraction);
  if (!object_pose) return std::nullopt;
  if (type != nullptr && type->length_m > 0 && !TouchesImageBorder(box, image_size)) {
    const double side_px = std::max(box.width, box.height);
    object_pose->range_m = object_pose->focal_px * kBoxLengthRatio * type->length_m / side_px;
    object_pose->sigma_range_m = std::hypot(kBoxLengthRatioSigma, type->length_fraction) * *object_pose->range_m;
  }
  std::optional<BearingObservation> observation = MakeBearingObservation(*object_pose, camera);
  if (observation) observation->recognition_id = recognition_id;
  return observation;
}

std::optional<PredictedBox> PredictBox(const GeodeticPoint& place, const Box& before, const CameraState& camera_before,
                                       const CameraState& camera, const cv::Size& image_size) {
  if (!camera_before.IsComplete() || !camera.IsComplete()) return std::nullopt;
  constexpr double kNorthM = 1;
  const GeodeticPoint north = TangentPlane(place).GeodeticFromEnu({0, kNorthM, 0});
  const auto was = Project(place, camera_before, image_size);
  const auto was_north = Project(north, camera_before, image_size);
  const auto is = Project(place, camera, image_size);
  const auto is_north = Project(north, camera, image_size);
  if (!was || !was_north || !is || !is_north) return std::nullopt;
  const double scale = was->m_per_px / is->m_per_px;
  const Vector2d from = was_north->pixel - was->pixel;
  const Vector2d to = is_north->pixel - is->pixel;
  const double width = scale * before.width;
  const double height = scale * before.height;
  return PredictedBox{{is->pixel.x() - width / 2, is->pixel.y() - height / 2, width, height},
                      WrapAngle(std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()))};
}

}  // namespace victorious
