// Compares the renderer's cast shadows (renderer.h) with geometry.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/cad_tools.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/render/renderer.h"

namespace victorious {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3d kToSun = Vector3d(0.5, -0.7, 0.9).normalized();

// White ground: half of the light from the sky, half from the visible sun. In sRGB: 188 in shadow, 255 in the sun.
Light SunAndSky(bool shadows, double softness_m = 0.05) {
  return {.sky = 0.5,
          .ground = 0.5,
          .sun = 0.5 / kToSun.z(),
          .to_sun_in_world = kToSun,
          .shadows = shadows,
          .shadow_softness_m = softness_m};
}
constexpr int kLit = 255;
constexpr int kShaded = 188;

const Vector3d kBoxLow(-1, -2, 0);
const Vector3d kBoxHigh(1, 1, 3);

PosedCamera CameraFrom(double azimuth_deg, double off_nadir_deg, double radius_m = 8, double distance_m = 60) {
  return *CameraForView({RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(off_nadir_deg)}, {{0, 0, 0}, radius_m},
                        {.distance_m = distance_m, .diameter_px = 300, .width_px = 240, .height_px = 200});
}

struct ShadowScene {
  Renderer renderer = *Renderer::Create({.software = true});
  std::vector<MeshInstance> instances;

  MeshId Add(const Mesh& mesh, const Rigid3& world_from_mesh = {}) {
    instances.push_back({*renderer.Upload(mesh), world_from_mesh});
    return instances.back().mesh;
  }
  RenderedView Render(const PosedCamera& camera, const Light& light) {
    auto view = renderer.Render(instances, camera, light);
    EXPECT_TRUE(view) << view.error().message;
    return *std::move(view);
  }
};

Mesh Ground() { return testing::Box({-20, -20, -1}, {20, 20, 0}); }

// A level square of side 4, 2 m above the ground, seen from above.
Mesh Roof(const cv::Mat& texture, AlphaMode mode) {
  Mesh roof = testing::TexturedSquare(texture);
  for (Vector3f& p : roof.positions) p = Vector3f(2 * p.x(), 2 * p.y(), 2);
  roof.materials[0].alpha_mode = mode;
  return roof;
}

Vector3d PointAt(const RenderedView& view, const PosedCamera& camera, int col, int row) {
  const double depth = view.depth_m.at<float>(row, col);
  return camera.camera_from_world.Inverse().Apply(depth * camera.pinhole.Unproject({col + 0.5, row + 0.5}));
}

int GreyAt(const RenderedView& view, int col, int row) { return view.bgr.at<cv::Vec3b>(row, col)[1]; }

// Grey value of the ground at a point, which must be in the image.
int GreyOfGround(const RenderedView& view, const PosedCamera& camera, const Vector3d& point) {
  const Eigen::Vector2d pixel = *camera.pinhole.Project(camera.camera_from_world.Apply(point));
  return GreyAt(view, static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
}

bool SunIsHidden(const Vector3d& point, const Vector3d& low, const Vector3d& high) {
  const Eigen::Array3d a = (low - point).array() / kToSun.array();
  const Eigen::Array3d b = (high - point).array() / kToSun.array();
  return std::max(a.min(b).maxCoeff(), 0.0) < a.max(b).minCoeff();
}

TEST(Shadow, LiesWhereTheBoxOccludesTheSun) {
  ShadowScene scene;
  scene.Add(Ground());
  scene.Add(testing::Box(kBoxLow.cast<float>(), kBoxHigh.cast<float>()));
  for (const double azimuth_deg : {0, 130, 250}) {
    const PosedCamera camera = CameraFrom(azimuth_deg, 40);
    const RenderedView view = scene.Render(camera, SunAndSky(true));
    cv::Mat ground = view.instances == 0;
    cv::erode(ground, ground, {});
    std::array<int, 2> seen = {};
    for (int row = 0; row < view.bgr.rows; ++row) {
      for (int col = 0; col < view.bgr.cols; ++col) {
        if (ground.at<std::uint8_t>(row, col) == 0) continue;
        const Vector3d point = PointAt(view, camera, col, row);
        const Vector3d margin = Vector3d::Constant(0.2);
        const bool hidden = SunIsHidden(point, kBoxLow + margin, kBoxHigh - margin);
        if (!hidden && SunIsHidden(point, kBoxLow - margin, kBoxHigh + margin)) continue;  // near the shadow's edge
        EXPECT_NEAR(GreyAt(view, col, row), hidden ? kShaded : kLit, 2) << point.transpose();
        ++seen[hidden ? 1 : 0];
      }
    }
    EXPECT_GT(seen[0], 10000);
    EXPECT_GT(seen[1], 200);
  }
}

TEST(Shadow, IsOffByDefault) {
  ShadowScene scene;
  scene.Add(Ground());
  scene.Add(testing::Box(kBoxLow.cast<float>(), kBoxHigh.cast<float>()));
  const PosedCamera camera = CameraFrom(130, 40);
  const RenderedView view = scene.Render(camera, SunAndSky(false));
  cv::Mat ground = view.instances == 0;
  cv::erode(ground, ground, {});
  double darkest = 0;
  std::vector<cv::Mat> channels;
  cv::split(view.bgr, channels);
  cv::minMaxLoc(channels[1], &darkest, nullptr, nullptr, nullptr, ground);
  EXPECT_EQ(darkest, kLit);
  EXPECT_GT(cv::norm(view.bgr, scene.Render(camera, SunAndSky(true)).bgr, cv::NORM_INF), 50);
  EXPECT_EQ(cv::norm(view.bgr, scene.Render(camera, SunAndSky(false, 3)).bgr, cv::NORM_INF), 0);
}

TEST(Shadow, ConvexBodyHasNoSelfShadow) {
  // Rotated, so that no face is parallel to an axis; small and far away, with the minimum and the maximum softness.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.6, Vector3d(1, 2, 3).normalized()));
  for (const float size_m : {0.3F, 3.0F, 60.0F}) {
    ShadowScene scene;
    scene.Add(testing::Box(Vector3f::Constant(-size_m), Vector3f::Constant(size_m)), {turn, {}});
    for (const double azimuth_deg : {20, 150, 310}) {
      const PosedCamera camera = CameraFrom(azimuth_deg, 45, 2 * size_m, 40 * size_m);
      for (const double softness_m : {0.02, 0.5}) {
        const RenderedView shaded = scene.Render(camera, SunAndSky(true, softness_m * size_m));
        const RenderedView plain = scene.Render(camera, SunAndSky(false));
        EXPECT_LE(cv::norm(shaded.bgr, plain.bgr, cv::NORM_INF), 4) << size_m << " " << softness_m;
      }
    }
  }
}

TEST(Shadow, PenumbraHasTheGivenWidth) {
  ShadowScene scene;
  scene.Add(Ground());
  scene.Add(testing::Box({-5, -5, 4}, {0, 5, 4.1F}));
  const PosedCamera camera = CameraFrom(0, 0, 4);
  // The sun is in the yz plane: the edge at x = 0 and its shadow both lie at x = 0.
  Light light = SunAndSky(true);
  light.to_sun_in_world = {0, 1, 1};
  light.sun = 0.5 * std::sqrt(2.0);
  const auto width_m = [&](double softness_m) {
    light.shadow_softness_m = softness_m;
    const RenderedView view = scene.Render(camera, light);
    double least = 1e9;
    double most = -1e9;
    for (double x = 0; x < 2; x += 0.01) {  // the half that the board does not occlude
      const int grey = GreyOfGround(view, camera, {x, 0, 0});
      if (grey > kShaded + 3 && grey < kLit - 3) {
        least = std::min(least, x);
        most = std::max(most, x);
      }
    }
    return 2 * (most - least);
  };
  EXPECT_NEAR(width_m(1.2), 1.2, 0.5);
  EXPECT_LT(width_m(0.05), 0.2);
}

// Grey values at the centre of a roof's shadow, and at that of its quarter towards +x and +y.
struct UnderRoof {
  int middle;
  int quarter;
};

UnderRoof ShadowOf(const Mesh& roof) {
  ShadowScene scene;
  scene.Add(Ground());
  scene.Add(roof);
  const PosedCamera camera = CameraFrom(90, 50);  // from the left: the roof hides nothing of its shadow
  const RenderedView view = scene.Render(camera, SunAndSky(true));
  const auto below = [&](double x, double y) -> Vector3d { return Vector3d(x, y, 2) - kToSun * (2 / kToSun.z()); };
  return {GreyOfGround(view, camera, below(-1, -1)), GreyOfGround(view, camera, below(1, 1))};
}

// White, with an alpha in the quarter towards +x and +y, opaque elsewhere.
cv::Mat QuarterClear(int alpha) {
  cv::Mat texture(64, 64, CV_8UC4, cv::Scalar::all(255));
  texture(cv::Rect(32, 0, 32, 32)).setTo(cv::Scalar(255, 255, 255, alpha));
  return texture;
}

TEST(Shadow, MaskedTexelsCastNoShadow) {
  const UnderRoof opaque = ShadowOf(Roof(QuarterClear(0), AlphaMode::kOpaque));
  EXPECT_NEAR(opaque.middle, kShaded, 2);
  EXPECT_NEAR(opaque.quarter, kShaded, 2);
  const UnderRoof cut = ShadowOf(Roof(QuarterClear(0), AlphaMode::kMask));
  EXPECT_NEAR(cut.middle, kShaded, 2);
  EXPECT_NEAR(cut.quarter, kLit, 2);
}

TEST(Shadow, BlendedSurfacesCastFromAlphaOneHalf) {
  EXPECT_NEAR(ShadowOf(Roof(QuarterClear(150), AlphaMode::kBlend)).quarter, kShaded, 2);
  EXPECT_NEAR(ShadowOf(Roof(QuarterClear(100), AlphaMode::kBlend)).quarter, kLit, 2);
  EXPECT_NEAR(ShadowOf(Roof(QuarterClear(100), AlphaMode::kBlend)).middle, kShaded, 2);
}

TEST(Shadow, IsCastByObjectsOutsideTheImage) {
  ShadowScene scene;
  scene.Add(Ground());
  // A tower towards the sun, 30 m from the visible region, high enough that its shadow reaches it.
  const Vector3d foot = 30 * Vector3d(kToSun.x(), kToSun.y(), 0).normalized();
  scene.Add(testing::Box({-1, -1, 0}, {1, 1, 40}), {Eigen::Quaterniond::Identity(), foot});
  const PosedCamera camera = CameraFrom(0, 0, 3);
  const RenderedView view = scene.Render(camera, SunAndSky(true));
  EXPECT_EQ(cv::countNonZero(view.instances != 0), 0);
  EXPECT_NEAR(GreyOfGround(view, camera, {0, 0, 0}), kShaded, 2);
  EXPECT_NEAR(GreyOfGround(view, camera, 1.5 * Vector3d(-kToSun.y(), kToSun.x(), 0).normalized()), kLit, 2);
}

TEST(Shadow, IsSharpOverATown) {
  // 300 m of ground, seen from 150 m above at 15 degrees, straight down and oblique: a pole 0.5 m thick casts a shadow.
  ShadowScene scene;
  scene.Add(testing::Box({-150, -150, -1}, {150, 150, 0}));
  scene.Add(testing::Box({-0.25, -0.25, 0}, {0.25, 0.25, 8}));
  for (const double off_nadir_deg : {0, 60}) {
    const double distance_m = 150 / std::cos(RadiansFromDegrees(off_nadir_deg));
    PosedCamera camera = CameraFrom(45, off_nadir_deg, 1, distance_m);
    const double focal_px = 320 / std::tan(RadiansFromDegrees(7.5));
    camera.pinhole = {.fx = focal_px, .fy = focal_px, .cx = 320, .cy = 240, .width = 640, .height = 480};
    const RenderedView view = scene.Render(camera, SunAndSky(true));
    const Vector3d along =
        -4 * Vector3d(kToSun.x(), kToSun.y(), 0) / kToSun.z();  // shadow of the point 4 m up the pole
    const Vector3d across = Vector3d(-kToSun.y(), kToSun.x(), 0).normalized();
    EXPECT_NEAR(GreyOfGround(view, camera, along), kShaded, 3);
    EXPECT_NEAR(GreyOfGround(view, camera, along + 0.6 * across), kLit, 3);
    EXPECT_NEAR(GreyOfGround(view, camera, along - 0.6 * across), kLit, 3);
  }
}

TEST(Shadow, BadSoftnessIsRefused) {
  ShadowScene scene;
  EXPECT_FALSE(scene.renderer.Render({}, CameraFrom(0, 0), {.shadow_softness_m = 0}));
  EXPECT_TRUE(scene.renderer.Render({}, CameraFrom(0, 0), {.shadows = true}));  // no mesh
}

}  // namespace
}  // namespace victorious
