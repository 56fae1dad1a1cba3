#include "victorious/lab/simulate/placed_scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/cad_tools.h"
#include "testing/data.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/lab/simulate/flight_path.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;

using Eigen::Vector3d;
using Eigen::Vector3f;

// A white town of one square that contains only the pieces of the scene; `town/block` is 40 m high and 8 m square.
class PlacedSceneTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(assets / "town/ground");
    fs::create_directories(assets / "town/tiles");
    ASSERT_TRUE(WriteImage(assets / "town/ground/grass.jpg", cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(255))));
    Write("town/tiles/flat", {-12, -0.05F, -12}, {12, 0, 12});
    Write("town/block", {-4, 0, -4}, {4, 40, 4});
  }

  // The file's up is y.
  void Write(const std::string& asset, const Vector3f& low, const Vector3f& high) {
    std::ofstream(assets / (asset + ".glb"), std::ios::binary) << testing::GlbFrom(testing::Box(low, high));
  }

  // The square from above, 26 m wide, the sun 15 degrees above the town's -x.
  cv::Mat RenderImage(const std::vector<ScenePiece>& pieces) {
    Scene scene;
    scene.assets = assets.path();
    scene.camera.off_nadir_deg = {0};
    scene.camera.range_m = {100};
    scene.video = {.width = 64, .height = 64, .hfov_deg = 15};
    scene.town = {.density = 0, .squares = {0, 0, 0, 0}, .tiles = {{.tile = "flat"}}};
    scene.pieces = pieces;
    const PosedCamera camera{MakePinhole(scene.video), CameraFromTown(scene.camera, 0, 0, 1)};
    const double elevation = RadiansFromDegrees(15);
    const Light light{
        .sky = 0.2, .sun = 1.5, .to_sun_in_world = {-std::cos(elevation), 0, std::sin(elevation)}, .shadows = true};
    Expected<Renderer> renderer = Renderer::Create({.software = true});
    EXPECT_TRUE(renderer);
    const auto placed = PlacedScene::Build(scene, *renderer, CancelToken(), [](const std::string&) {});
    EXPECT_TRUE(placed) << placed.error().message;
    const auto view =
        renderer->Render(placed->FindVisibleTownInstances(camera, light.to_sun_in_world), camera, light, {});
    EXPECT_TRUE(view) << view.error().message;
    return view->bgr;
  }

  testing::ScratchFolder assets;
};

TEST_F(PlacedSceneTest, ShadowsOfObjectsOutsideTheViewAreRendered) {
  const cv::Mat without = RenderImage({});
  // A block 40 m high casts a shadow 149 m long.
  for (const double distance_m : {40.0, 90.0, 130.0}) {
    const cv::Mat with = RenderImage({{.asset = "town/block", .x_m = -distance_m}});
    EXPECT_LT(with.at<cv::Vec3b>(32, 32)[0] + 40, without.at<cv::Vec3b>(32, 32)[0]) << distance_m;
    EXPECT_EQ(with.at<cv::Vec3b>(4, 32), without.at<cv::Vec3b>(4, 32)) << distance_m;  // beside the shadow
  }
  EXPECT_EQ(cv::norm(RenderImage({{.asset = "town/block", .x_m = -170}}), without, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(RenderImage({{.asset = "town/block", .x_m = 40}}), without, cv::NORM_INF), 0);  // on the lee side
}

}  // namespace
}  // namespace victorious
