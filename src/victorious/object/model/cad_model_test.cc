#include "victorious/object/model/cad_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/cad_tools.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Vector3d kHalfSize(1.0, 0.5, 0.4);

// A texture of random grey blobs; the pattern depends on the seed.
cv::Mat Blots(std::uint64_t seed) {
  cv::Mat texture(128, 128, CV_8UC4, cv::Scalar(120, 120, 120, 255));
  Random random(seed);
  for (int i = 0; i < 120; ++i) {
    const cv::Point at(static_cast<int>(random.Below(128)), static_cast<int>(random.Below(128)));
    cv::circle(texture, at, 3 + static_cast<int>(random.Below(6)),
               cv::Scalar(cv::Scalar::all(static_cast<double>(random.Below(256)))), cv::FILLED);
  }
  const cv::Mat alpha(texture.size(), CV_8UC1, cv::Scalar(255));
  cv::insertChannel(alpha, texture, 3);
  return texture;
}

Mesh BlottedBox() {
  Mesh box = testing::Box((-kHalfSize).cast<float>(), kHalfSize.cast<float>());
  for (std::size_t face = 0; face < box.materials.size(); ++face) {
    box.textures.push_back(Blots(face + 1));
    box.materials[face].texture = static_cast<int>(face);
  }
  return box;
}

CadModelOptions FewViews() {
  CadModelOptions options;
  options.sphere = {.step_deg = 30, .max_off_nadir_deg = 60};
  options.min_size_px = 280;
  options.max_size_px = 280;
  return options;
}

const ObjectModel& BoxModel() {
  static const ObjectModel model = [] {
    auto made = MakeCadModel("box", BlottedBox(), "box.glb", FewViews());
    EXPECT_TRUE(made) << made.error().message;
    return made.value_or(ObjectModel{});
  }();
  return model;
}

// Distance of a point from the surface of the box, m.
double DistanceFromSurface(const Vector3d& point) {
  const Vector3d beyond = point.cwiseAbs() - kHalfSize;
  return beyond.maxCoeff() > 0 ? beyond.cwiseMax(0).norm() : -beyond.maxCoeff();
}

Vector3d PointOf(const Point3& point) { return {point.x, point.y, point.z}; }

// The camera of a view, computed from the options and the stored view angles.
PosedCamera CameraOf(const ModelView& view) {
  const CadModelOptions options = FewViews();
  const double radius_m = kHalfSize.norm();
  return *CameraForView(*view.angles, {{0, 0, 0}, radius_m},
                        {.distance_m = kTemplateDistanceRadii * radius_m,
                         .diameter_px = static_cast<double>(options.max_size_px),
                         .width_px = view.width,
                         .height_px = view.height});
}

TEST(MakeCadModel, EveryFeatureHasAPointOnTheObject) {
  const ObjectModel& model = BoxModel();
  ASSERT_GT(model.features.size(), 2000);
  ASSERT_EQ(model.points_in_model.size(), model.features.size());
  std::vector<double> distances_m;
  for (const Point3& point : model.points_in_model) distances_m.push_back(DistanceFromSurface(PointOf(point)));
  std::ranges::sort(distances_m);
  EXPECT_LT(distances_m[distances_m.size() / 2], 0.002);
  EXPECT_LT(distances_m[distances_m.size() * 95 / 100], 0.005);
  EXPECT_LT(distances_m.back(), 0.02);
}

TEST(MakeCadModel, PointsProjectToTheirKeypoints) {
  const ObjectModel& model = BoxModel();
  for (const ModelView& view : model.views) {
    const PosedCamera camera = CameraOf(view);
    for (std::uint64_t i = view.first_feature; i < view.first_feature + view.feature_count; ++i) {
      const Vector3d place = PointOf(model.points_in_model[i]);
      const Eigen::Vector2d seen = *camera.pinhole.Project(camera.camera_from_world.Apply(place));
      EXPECT_NEAR(seen.x(), model.features.keypoints[i].x, 0.01);
      EXPECT_NEAR(seen.y(), model.features.keypoints[i].y, 0.01);
    }
  }
}

TEST(MakeCadModel, AnglesGiveTheCameraDirection) {
  // The points of a view lie on the side of the camera: d = (-cos az sin off, sin az sin off, cos off), by the
  // definition of azimuth and off-nadir angle.
  const ObjectModel& model = BoxModel();
  ASSERT_EQ(model.views.size(), 25);
  for (const ModelView& view : model.views) {
    ASSERT_TRUE(view.angles);
    const auto [azimuth, off_nadir] = *view.angles;
    const Vector3d to_camera(-std::cos(azimuth) * std::sin(off_nadir), std::sin(azimuth) * std::sin(off_nadir),
                             std::cos(off_nadir));
    EXPECT_GT(view.feature_count, 20);
    for (std::uint64_t i = view.first_feature; i < view.first_feature + view.feature_count; ++i) {
      const Vector3d place = PointOf(model.points_in_model[i]);
      Eigen::Index axis = 0;
      (place.cwiseAbs() - kHalfSize).maxCoeff(&axis);  // of the face that the place is on
      EXPECT_GT(place[axis] * to_camera[axis], -1e-9);
    }
  }
}

TEST(MakeCadModel, NeighboursAreMutualAndAdjacent) {
  const ObjectModel& model = BoxModel();
  for (std::uint32_t i = 0; i < model.views.size(); ++i) {
    EXPECT_FALSE(model.views[i].neighbours.empty());
    for (const std::uint32_t neighbour : model.views[i].neighbours) {
      EXPECT_NE(neighbour, i);
      EXPECT_THAT(model.views[neighbour].neighbours, ::testing::Contains(i));
      const auto direction = [&](std::uint32_t view) { return DirectionToCamera(*model.views[view].angles); };
      EXPECT_GT(direction(i).dot(direction(neighbour)), std::cos(RadiansFromDegrees(45)));
    }
  }
}

TEST(MakeCadModel, ViewsHaveOutlinesAndThumbnails) {
  const ObjectModel& model = BoxModel();
  EXPECT_EQ(model.kind, ModelKind::kCad);
  EXPECT_DOUBLE_EQ(*model.length_m, 2);
  for (const ModelView& view : model.views) {
    EXPECT_GE(view.outline.size(), 3);
    EXPECT_FALSE(view.thumbnail.empty());
    const Box outline = BoundingBox(view.outline);
    const PosedCamera camera = CameraOf(view);
    Eigen::AlignedBox2d expected;
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
      expected.extend(*camera.pinhole.Project(camera.camera_from_world.Apply(kHalfSize.cwiseProduct(sign))));
    }
    constexpr double kSimplifiedPx = 4;
    EXPECT_NEAR(outline.x, expected.min().x(), kSimplifiedPx);
    EXPECT_NEAR(outline.y, expected.min().y(), kSimplifiedPx);
    EXPECT_NEAR(outline.x + outline.width, expected.max().x(), kSimplifiedPx);
    EXPECT_NEAR(outline.y + outline.height, expected.max().y(), kSimplifiedPx);
  }
}

TEST(MakeCadModel, ProgressCountsAllViews) {
  int last = 0;
  int all = 0;
  ASSERT_TRUE(MakeCadModel("box", BlottedBox(), "box.glb", FewViews(), [&](int done, int of) {
    EXPECT_GT(done, last);
    last = done;
    all = of;
  }));
  EXPECT_EQ(last, 25);
  EXPECT_EQ(all, 25);
}

TEST(MakeCadModel, UntexturedModelIsAnError) {
  CadModelOptions options = FewViews();
  options.min_features = 200;  // more than the edges of a box give
  const auto model = MakeCadModel("plain", testing::Box({-1, -1, -1}, {1, 1, 1}), "plain.stl", options);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(model.error().message, AllOf(HasSubstr("plain.stl"), HasSubstr("200 features"), HasSubstr("texture")));
  EXPECT_EQ(model.error().message.find('\n'), std::string::npos);
}

TEST(MakeCadModel, IsCancelled) {
  CancelToken cancel;
  cancel.CancelAtPoll(3);
  const auto made = MakeCadModel("box", BlottedBox(), "box.glb", FewViews(), {}, &cancel);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCancelled);
}

TEST(MakeCadModel, RefusesOptionsOutOfRange) {
  CadModelOptions options = FewViews();
  options.min_mask_fraction = 2;
  EXPECT_FALSE(MakeCadModel("box", BlottedBox(), "box.glb", options));
  options.min_mask_fraction = 0.3;
  options.min_size_px = 300;
  options.max_size_px = 200;
  EXPECT_FALSE(MakeCadModel("box", BlottedBox(), "box.glb", options));
}

}  // namespace
}  // namespace victorious
