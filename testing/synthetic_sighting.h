// Shared by the tests of object poses and bearing observations: an object of known place before a camera, and its
// detection.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/lens.h"
#include "victorious/types/camera_state.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious::testing {

inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
inline const double kFocalPx = kWidth / 2.0 / std::tan(RadiansFromDegrees(16) / 2);

inline CameraState LookingDown(double pitch_deg, double yaw_deg) {
  return {.time_s = 2,
          .place = {0.8, 0.2, 500},
          .attitude = Attitude{RadiansFromDegrees(yaw_deg), RadiansFromDegrees(pitch_deg), 0.03},
          .hfov_rad = RadiansFromDegrees(16)};
}

// A model with one view whose points have a centre off the origin, and what a camera sees of it.
struct SyntheticSighting {
  ObjectModel model;
  std::shared_ptr<FeatureSet> features = std::make_shared<FeatureSet>();
  std::shared_ptr<std::vector<Point3>> points = std::make_shared<std::vector<Point3>>();
  FeatureSet scene;
  Detection detection;
};

// The object is upright at `object_enu` from the camera, its front towards `heading_deg`, seen through `lens`; the
// matched view is a few degrees off.
inline SyntheticSighting MakeSyntheticSighting(const CameraState& camera, const Eigen::Vector3d& object_enu,
                                               double heading_deg, const LensDistortion& lens) {
  SyntheticSighting sighting;
  const Eigen::Vector3d middle(0.5, 0, 1);
  const Eigen::Quaterniond camera_from_enu = CameraFromEnu(*camera.attitude);
  // Front along the heading, left a quarter turn counter-clockwise of it.
  const Eigen::AngleAxisd enu_from_model(kPi / 2 - RadiansFromDegrees(heading_deg), Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d to_camera = enu_from_model.inverse() * (-object_enu.normalized());
  ModelView view{.width = 400, .height = 400};
  view.angles = ViewDirection{std::atan2(to_camera.y(), -to_camera.x()) + RadiansFromDegrees(4),
                              std::acos(to_camera.z()) - RadiansFromDegrees(3)};
  sighting.scene.image_width = kWidth;
  sighting.scene.image_height = kHeight;
  const auto show = [&](const Eigen::Vector3d& off_middle) {
    const Eigen::Vector3d p = camera_from_enu * (object_enu + enu_from_model * off_middle);
    return Eigen::Vector2d(kFocalPx * Distort({p.x() / p.z(), p.y() / p.z()}, lens) +
                           Eigen::Vector2d(kWidth / 2.0, kHeight / 2.0));
  };
  for (int i = 0; i < 24; ++i) {
    const Eigen::Vector3d off((i % 3 - 1) * 1.8, (i / 3 % 4 - 1.5) * 0.6, i % 2 == 0 ? 0.9 : 0.2 * (i % 5));
    const Eigen::Vector2d seen = show(off);
    sighting.scene.keypoints.push_back({static_cast<float>(seen.x()), static_cast<float>(seen.y())});
    sighting.features->keypoints.push_back({});
    const Eigen::Vector3f point = (middle + off).cast<float>();
    sighting.points->push_back({point.x(), point.y(), point.z()});
    sighting.detection.fit.inliers.push_back({.scene_keypoint = static_cast<std::uint32_t>(i),
                                              .keypoint_in_template = {},
                                              .point_in_model = sighting.points->back()});
  }
  // The template's upright is the model's up: its in-plane rotation in the image.
  const Eigen::Vector2d up = show({0, 0, 1}) - show({0, 0, -1});
  Similarity2& similarity = sighting.detection.fit.scene_from_template;
  similarity.rotation_rad = std::atan2(up.x(), -up.y());
  similarity.scale = 0.2;
  similarity.translation = show({0, 0, 0}) - similarity.Linear() * Eigen::Vector2d(200, 200);
  sighting.model.kind = ModelKind::kCad;
  sighting.model.views.push_back(view);
  sighting.model.features = sighting.features->View();
  sighting.model.points_in_model = *sighting.points;
  sighting.model.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-2, -1, 0), Eigen::Vector3d(3, 1, 2));
  return sighting;
}

}  // namespace victorious::testing
