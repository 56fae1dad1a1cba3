#include "victorious/lab/simulate/truth.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "testing/cad_tools.h"
#include "victorious/geometry/angles.h"
#include "victorious/lab/simulate/flight_path.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr double kTownHeadingRad = 0.3;
const TangentPlane kEarth({RadiansFromDegrees(42), RadiansFromDegrees(-71), 10});

// A nadir camera 100 m above the town's origin, the town's y upwards in the image: 6.4 px per metre.
PosedCamera FromAbove() {
  SceneCamera camera;
  camera.off_nadir_deg = {0};
  camera.range_m = {100};
  const double focal = 640;
  return {{.fx = focal, .fy = focal, .cx = 160, .cy = 120, .width = 320, .height = 240},
          CameraFromTown(camera, 0, 0, 1)};
}

class Truth : public ::testing::Test {
 protected:
  // A box 4 m long, 2 m wide and 1 m high, its front to the east of the town.
  PlacedMesh BoxAt(const Vector3d& place, double height_m = 1) {
    const Mesh mesh = testing::Box({-2, -1, 0}, {2, 1, static_cast<float>(height_m)});
    const Expected<MeshId> id = renderer->Upload(mesh);
    EXPECT_TRUE(id);
    return {{*id, BoundingBox(mesh)}, {Eigen::Quaterniond::Identity(), place}};
  }

  std::vector<ObjectTruth> TruthOfBoxes(const std::vector<PlacedMesh>& boxes, std::size_t objects,
                                        const PosedCamera& camera = FromAbove()) {
    std::vector<MeshInstance> instances(boxes.size());
    std::ranges::transform(boxes, instances.begin(), [](const PlacedMesh& box) {
      return MeshInstance{.mesh = box.mesh.id, .world_from_mesh = box.town_from_mesh};
    });
    const Expected<RenderedView> view = renderer->Render(instances, camera);
    EXPECT_TRUE(view);
    const auto truth =
        ComputeTruth(std::span(boxes).first(objects), view->instances, camera, kEarth, kTownHeadingRad, *renderer);
    EXPECT_TRUE(truth) << truth.error().message;
    return truth ? *truth : std::vector<ObjectTruth>();
  }

  Expected<Renderer> renderer = Renderer::Create({.software = true});
};

TEST_F(Truth, SingleObjectHasBoxPlaceHeadingAndView) {
  const auto truth = TruthOfBoxes({BoxAt({0, 0, 0})}, 1);
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_EQ(truth[0].visible, 1);
  EXPECT_EQ(truth[0].pixels, 26 * 12);  // its top is 99 m away: 25.9 x 12.9 px
  EXPECT_EQ(truth[0].box, (Box{147, 114, 26, 12}));
  EXPECT_LT((kEarth.EnuFromGeodetic(truth[0].place) - Vector3d(0, 0, 0.5)).norm(), 1e-6);
  EXPECT_NEAR(truth[0].heading_rad, kPi / 2 + kTownHeadingRad, 1e-9);
  EXPECT_NEAR(truth[0].view.off_nadir_rad, 0, 1e-6);
  EXPECT_EQ(truth[0].speed_m_s, 0);
  EXPECT_FALSE(truth[0].course_rad);
}

TEST_F(Truth, MotionIsRelativeToNorth) {
  PlacedMesh box = BoxAt({0, 0, 0});
  box.velocity_in_town = {3, 3};  // 45 degrees clockwise from the town's y axis
  const auto truth = TruthOfBoxes({box}, 1);
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_NEAR(truth[0].speed_m_s, 3 * std::sqrt(2), 1e-9);
  ASSERT_TRUE(truth[0].course_rad);
  EXPECT_NEAR(*truth[0].course_rad, kPi / 4 + kTownHeadingRad, 1e-6);
}

TEST_F(Truth, HalfOccludedObjectIsHalfVisible) {
  const std::vector<PlacedMesh> boxes = {BoxAt({0, 0, 0}), BoxAt({2, 0, 2})};
  const auto truth = TruthOfBoxes(boxes, 1);
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_NEAR(truth[0].visible, 0.5, 0.05);
  EXPECT_NEAR(truth[0].box.x + truth[0].box.width, 160, 1);
  EXPECT_TRUE(TruthOfBoxes({BoxAt({0, 0, 0}), BoxAt({0, 0, 2})}, 1).empty());  // occluding all of it leaves no truth
}

TEST_F(Truth, CroppedPixelsCountAsInvisible) {
  const auto truth = TruthOfBoxes({BoxAt({160 / 6.4, 0, 0})}, 1);  // on the frame's right border
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_NEAR(truth[0].visible, 0.5, 0.05);
  EXPECT_EQ(truth[0].box.x + truth[0].box.width, 320);
}

TEST_F(Truth, ViewAnglesAreInTheObjectFrame) {
  SceneCamera behind;  // south of it; the object looks east: the camera is on its right
  behind.off_nadir_deg = {40};
  PosedCamera camera = FromAbove();
  camera.camera_from_world = CameraFromTown(behind, 0, 0, 1);
  const auto truth = TruthOfBoxes({BoxAt({0, 0, -0.5})}, 1, camera);
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_NEAR(DegreesFromRadians(truth[0].view.azimuth_rad), 270, 1e-6);
  EXPECT_NEAR(DegreesFromRadians(truth[0].view.off_nadir_rad), 40, 1e-6);
}

// Rendered alone it would need an image 6400 pixels wide, more than the limit: the truth must still be computed.
TEST_F(Truth, ObjectWiderThanTheFrameHasItsVisibleFraction) {
  const Mesh mesh = testing::Box({-500, -1, -1}, {500, 1, 0});  // 1000 m long, its top at 0: 6.4 px a metre
  const Expected<MeshId> id = renderer->Upload(mesh);
  ASSERT_TRUE(id);
  const auto truth = TruthOfBoxes({{{*id, BoundingBox(mesh)}, {}}}, 1);
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_EQ(truth[0].box.width, 320);
  EXPECT_NEAR(truth[0].visible, 320 / 6400.0, 0.005);
}

TEST_F(Truth, ObjectReachingBehindTheCameraIsBarelyVisible) {
  const auto truth = TruthOfBoxes({BoxAt({3, 0, 0}, 120)}, 1);  // a tower beside the camera, higher than that
  ASSERT_EQ(truth.size(), 1U);
  EXPECT_GT(truth[0].visible, 0);
  EXPECT_LT(truth[0].visible, 0.1);
}

TEST(FormatTruthLine, HasTheDocumentedKeys) {
  const ObjectTruth truth{.box = {1, 2, 30, 40}, .pixels = 600, .visible = 0.51239, .place = {0.7, -1.2, 11}};
  const auto json = nlohmann::json::parse(FormatTruthLine(truth, {.id = "jeep-1", .model = "jeep"}, 37, 3.7));
  EXPECT_EQ(json["frame"], 37);
  EXPECT_EQ(json["object"], "jeep-1");
  EXPECT_EQ(json["box"], nlohmann::json({1, 2, 30, 40}));
  EXPECT_EQ(json["visible"], 0.5124);
  EXPECT_EQ(json["pixels"], 600);
  EXPECT_NEAR(json["latitude_deg"].get<double>(), DegreesFromRadians(0.7), 1e-9);
  EXPECT_TRUE(json["view"].contains("azimuth_deg") && json["view"].contains("off_nadir_deg"));
}

}  // namespace
}  // namespace victorious
