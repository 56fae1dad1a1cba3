#include "victorious/object/render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "testing/cad_tools.h"
#include "testing/data.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/view_direction.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using ::testing::HasSubstr;

const Light kEven = {.sky = 1, .ground = 1, .sun = 0};  // unshaded: every surface in its base colour

Renderer MakeRenderer() {
  auto renderer = Renderer::Create({.software = true});
  EXPECT_TRUE(renderer) << renderer.error().message;
  return *std::move(renderer);
}

RenderedView RenderOrDie(const Mesh& mesh, const PosedCamera& camera, const Light& light = kEven,
                         const RenderOptions& options = {}) {
  Renderer renderer = MakeRenderer();
  const auto id = renderer.Upload(mesh);
  EXPECT_TRUE(id);
  auto view = renderer.Render(std::vector<MeshInstance>{{*id, {}}}, camera, light, options);
  EXPECT_TRUE(view) << view.error().message;
  return *std::move(view);
}

PosedCamera CameraAt(double azimuth_deg, double off_nadir_deg, double radius = 1, double diameter_px = 200) {
  const ViewDirection direction{RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(off_nadir_deg)};
  const auto camera =
      CameraForView(direction, {{0, 0, 0}, radius},
                    {.distance_m = 6 * radius, .diameter_px = diameter_px, .width_px = 240, .height_px = 200});
  EXPECT_TRUE(camera);
  return *camera;
}

// -x red, +x green, -y blue, +y yellow, -z black, +z white: behind, front, right, left, below, above.
Mesh ColouredCube() {
  return testing::Box(Vector3f::Constant(-0.5F), Vector3f::Constant(0.5F),
                      {Vector3f(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 0, 0}, {1, 1, 1}});
}

// A square of side 2, perpendicular to the optical axis of the camera at azimuth 0, facing it.
Mesh SquareFacingBack(const cv::Mat& texture = cv::Mat(1, 1, CV_8UC4, cv::Scalar::all(255))) {
  Mesh mesh = testing::TexturedSquare(texture);
  // File +z is seen from behind: -x of the model; file +x is right of it: -y; file +y is up.
  for (auto* vectors : {&mesh.positions, &mesh.normals}) {
    for (Vector3f& v : *vectors) v = Vector3f(-v.z(), -v.x(), v.y());
  }
  return mesh;
}

cv::Vec3b At(const RenderedView& view, const Eigen::Vector2d& pixel) {
  return view.bgr.at<cv::Vec3b>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
}

cv::Vec3b Middle(const RenderedView& view) { return At(view, {view.bgr.cols / 2.0, view.bgr.rows / 2.0}); }

MATCHER_P(IsColour, colour, "") {
  int largest = 0;
  for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(int{arg[i]} - int{colour[i]}));
  return largest <= 2;
}

const cv::Vec3b kRed(0, 0, 255);
const cv::Vec3b kGreen(0, 255, 0);
const cv::Vec3b kBlue(255, 0, 0);
const cv::Vec3b kYellow(0, 255, 255);
const cv::Vec3b kWhite(255, 255, 255);
const cv::Vec3b kGrey(128, 128, 128);

TEST(Renderer, ViewAnglesShowTheirSides) {
  EXPECT_THAT(Middle(RenderOrDie(ColouredCube(), CameraAt(0, 90))), IsColour(kRed));
  EXPECT_THAT(Middle(RenderOrDie(ColouredCube(), CameraAt(90, 90))), IsColour(kYellow));
  EXPECT_THAT(Middle(RenderOrDie(ColouredCube(), CameraAt(180, 90))), IsColour(kGreen));
  EXPECT_THAT(Middle(RenderOrDie(ColouredCube(), CameraAt(270, 90))), IsColour(kBlue));
  EXPECT_THAT(Middle(RenderOrDie(ColouredCube(), CameraAt(0, 0))), IsColour(kWhite));
}

TEST(Renderer, ImageIsUprightAndNotMirrored) {
  const auto sees = [](const PosedCamera& camera, const Vector3d& point) {
    static const RenderedView view = RenderOrDie(ColouredCube(), CameraAt(45, 50));
    return At(view, *camera.pinhole.Project(camera.camera_from_world.Apply(point)));
  };
  const PosedCamera camera = CameraAt(45, 50);  // behind it, on its left
  EXPECT_THAT(sees(camera, {0, 0, 0.5}), IsColour(kWhite));
  EXPECT_THAT(sees(camera, {-0.5, 0, 0}), IsColour(kRed));
  EXPECT_THAT(sees(camera, {0, 0.5, 0}), IsColour(kYellow));
  const Eigen::Vector2d left = *camera.pinhole.Project(camera.camera_from_world.Apply({0, 0.5, 0}));
  const Eigen::Vector2d back = *camera.pinhole.Project(camera.camera_from_world.Apply({-0.5, 0, 0}));
  const Eigen::Vector2d top = *camera.pinhole.Project(camera.camera_from_world.Apply({0, 0, 0.5}));
  EXPECT_LT(left.x(), back.x());  // seen from behind, the left side is on the left
  EXPECT_LT(top.y(), std::min(left.y(), back.y()));
}

TEST(Renderer, CornersMatchPinholeProjection) {
  for (const auto& [azimuth_deg, off_nadir_deg] : {std::pair(0, 0), {30, 40}, {200, 70}, {315, 55}}) {
    const PosedCamera camera = CameraAt(azimuth_deg, off_nadir_deg);
    const RenderedView view = RenderOrDie(ColouredCube(), camera);
    Eigen::AlignedBox2d expected;
    for (const Vector3f& corner : ColouredCube().positions) {
      expected.extend(*camera.pinhole.Project(camera.camera_from_world.Apply(corner.cast<double>())));
    }
    // Each border of the silhouette with subpixel accuracy, from the coverage of the corner's pixels.
    const cv::Rect box = cv::boundingRect(view.mask);
    EXPECT_NEAR(box.x, expected.min().x(), 1.0);
    EXPECT_NEAR(box.y, expected.min().y(), 1.0);
    EXPECT_NEAR(box.br().x, expected.max().x(), 1.0);
    EXPECT_NEAR(box.br().y, expected.max().y(), 1.0);
  }
}

TEST(Renderer, EdgesAreAccurateToATenthOfAPixel) {
  const PosedCamera camera = CameraAt(0, 90, 1, 151);
  const RenderedView view = RenderOrDie(SquareFacingBack(), camera, kEven, {.supersampling = 8});
  const auto corner = [&](double y, double z) {
    return *camera.pinhole.Project(camera.camera_from_world.Apply({0, y, z}));
  };
  // Coverage of a row and of a column.
  EXPECT_NEAR(cv::sum(view.mask.row(100))[0] / 255, corner(-1, 0).x() - corner(1, 0).x(), 0.15);
  EXPECT_NEAR(cv::sum(view.mask.col(120))[0] / 255, corner(0, -1).y() - corner(0, 1).y(), 0.15);
  // Centre of the covered part.
  const cv::Moments moments = cv::moments(view.mask);
  EXPECT_NEAR(moments.m10 / moments.m00 + 0.5, 120, 0.02);
  EXPECT_NEAR(moments.m01 / moments.m00 + 0.5, 100, 0.02);
}

TEST(Renderer, DepthMatchesRayPlaneIntersection) {
  const PosedCamera camera = CameraAt(30, 40);
  const RenderedView view = RenderOrDie(ColouredCube(), camera);
  const Rigid3 world_from_camera = camera.camera_from_world.Inverse();
  int seen = 0;
  for (int row = 0; row < view.depth_m.rows; ++row) {
    for (int col = 0; col < view.depth_m.cols; ++col) {
      const Vector3d ray = camera.pinhole.Unproject({col + 0.5, row + 0.5});
      const Vector3d origin = world_from_camera.translation;
      const Vector3d direction = world_from_camera.rotation * ray;
      // Slab test: the ray is inside the cube from `enter` to `leave`.
      const Eigen::Array3d a = (-0.5 - origin.array()) / direction.array();
      const Eigen::Array3d b = (0.5 - origin.array()) / direction.array();
      const double enter = a.min(b).maxCoeff();
      const double leave = a.max(b).minCoeff();
      const float depth = view.depth_m.at<float>(row, col);
      if (leave - enter > 0.02) {
        EXPECT_NEAR(depth / enter, 1, 1e-5);
        EXPECT_EQ(view.instances.at<std::int32_t>(row, col), 0);
        ++seen;
      } else if (enter - leave > 0.02) {
        EXPECT_TRUE(std::isnan(depth));
        EXPECT_EQ(view.instances.at<std::int32_t>(row, col), -1);
      }
    }
  }
  EXPECT_GT(seen, 5000);
}

TEST(Renderer, MaskAreaMatchesSilhouette) {
  const PosedCamera camera = CameraAt(0, 90, 1, 100);
  const RenderedView view = RenderOrDie(SquareFacingBack(), camera);
  const double side_px = 2 * camera.pinhole.fx / 6;
  EXPECT_NEAR(cv::sum(view.mask)[0] / 255, side_px * side_px, 0.01 * side_px * side_px);
  EXPECT_EQ(view.mask.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(view.mask.at<std::uint8_t>(100, 120), 255);
  EXPECT_THAT(At(view, {0, 0}), IsColour(kGrey));
  EXPECT_THAT(At(RenderOrDie(SquareFacingBack(), camera, kEven, {.background = 30}), {0, 0}),
              IsColour(cv::Vec3b(30, 30, 30)));
}

TEST(Renderer, BackFacesAreCulledUnlessDoubleSided) {
  Mesh square = SquareFacingBack();
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90))), IsColour(kWhite));
  const RenderedView behind = RenderOrDie(square, CameraAt(180, 90));
  EXPECT_EQ(cv::countNonZero(behind.mask), 0);
  EXPECT_TRUE(std::isnan(behind.depth_m.at<float>(100, 120)));
  square.materials[0].double_sided = true;
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(180, 90))), IsColour(kWhite));
}

TEST(Renderer, DoubleSidedTrianglesAreLitOnTheVisibleSide) {
  Mesh square = SquareFacingBack();
  square.materials[0].double_sided = true;
  const Light from_behind = {.sky = 0, .ground = 0, .sun = 1, .to_sun_in_world = {-1, 0, 0}};
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90), from_behind)), IsColour(kWhite));
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(180, 90), from_behind)), IsColour(cv::Vec3b(0, 0, 0)));
  for (Vector3f& normal : square.normals) normal = -normal;  // normals opposite to the winding
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90), from_behind)), IsColour(kWhite));
}

TEST(Renderer, ShadingIsLambertian) {
  // 0.25 of linear light is 137 in sRGB.
  Mesh square = SquareFacingBack();
  const cv::Vec3b quarter(137, 137, 137);
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90), {.sky = 0.4, .ground = 0.1, .sun = 0})), IsColour(quarter));
  const Light aslant = {.sky = 0, .ground = 0, .sun = 0.5, .to_sun_in_world = {-0.5, 0, std::sqrt(0.75)}};
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90), aslant)), IsColour(quarter));
  square.materials[0].base_colour.head<3>().setConstant(0.25F);
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90))), IsColour(quarter));
}

TEST(Renderer, TexturesAreUprightWithCorrectColours) {
  const cv::Mat texture(64, 64, CV_8UC4);
  texture(cv::Rect(0, 0, 32, 32)).setTo(cv::Scalar(10, 20, 200, 255));
  texture(cv::Rect(32, 0, 32, 32)).setTo(cv::Scalar(10, 200, 20, 255));
  texture(cv::Rect(0, 32, 32, 32)).setTo(cv::Scalar(200, 20, 10, 255));
  texture(cv::Rect(32, 32, 32, 32)).setTo(cv::Scalar(137, 137, 137, 255));
  const RenderedView view = RenderOrDie(SquareFacingBack(texture), CameraAt(0, 90, 1, 150));
  EXPECT_THAT(At(view, {90, 70}), IsColour(cv::Vec3b(10, 20, 200)));
  EXPECT_THAT(At(view, {150, 70}), IsColour(cv::Vec3b(10, 200, 20)));
  EXPECT_THAT(At(view, {90, 130}), IsColour(cv::Vec3b(200, 20, 10)));
  EXPECT_THAT(At(view, {150, 130}), IsColour(cv::Vec3b(137, 137, 137)));
}

TEST(Renderer, TextureWrapModesAreApplied) {
  const cv::Mat texture(64, 64, CV_8UC4, cv::Scalar(0, 0, 255, 255));
  texture.colRange(32, 64).setTo(cv::Scalar(255, 0, 0, 255));  // red, then blue
  Mesh square = SquareFacingBack(texture);
  for (Eigen::Vector2f& uv : square.uvs) uv *= 2;
  const auto third_quarter = [&](TextureWrap wrap) {
    square.materials[0].wrap_u = wrap;
    return At(RenderOrDie(square, CameraAt(0, 90, 1, 150)), {138, 100});  // u = 1.24
  };
  EXPECT_THAT(third_quarter(TextureWrap::kRepeat), IsColour(kRed));
  EXPECT_THAT(third_quarter(TextureWrap::kClamp), IsColour(kBlue));
  EXPECT_THAT(third_quarter(TextureWrap::kMirror), IsColour(kBlue));
}

TEST(Renderer, VertexColoursModulate) {
  Mesh square = SquareFacingBack();
  square.colours.assign(4, {0, 0, 1, 1});
  EXPECT_THAT(Middle(RenderOrDie(square, CameraAt(0, 90))), IsColour(kBlue));
}

// The left half is opaque, the right half has an alpha of 102 / 255 = 0.4.
Mesh HalfClearSquare(AlphaMode mode) {
  const cv::Mat texture(64, 64, CV_8UC4, cv::Scalar::all(255));
  texture.colRange(32, 64).setTo(cv::Scalar(255, 255, 255, 102));
  Mesh square = SquareFacingBack(texture);
  square.materials[0].alpha_mode = mode;
  return square;
}

TEST(Renderer, AlphaModesOpaqueMaskAndBlend) {
  const PosedCamera camera = CameraAt(0, 90, 1, 150);
  const Eigen::Vector2d left(90, 100);
  const Eigen::Vector2d right(150, 100);
  const auto depth = [&](const RenderedView& view, const Eigen::Vector2d& at) {
    return view.depth_m.at<float>(static_cast<int>(at.y()), static_cast<int>(at.x()));
  };
  const RenderedView opaque = RenderOrDie(HalfClearSquare(AlphaMode::kOpaque), camera);
  EXPECT_THAT(At(opaque, right), IsColour(kWhite));
  const RenderedView masked = RenderOrDie(HalfClearSquare(AlphaMode::kMask), camera);
  EXPECT_THAT(At(masked, left), IsColour(kWhite));
  EXPECT_THAT(At(masked, right), IsColour(kGrey));
  EXPECT_EQ(masked.mask.at<std::uint8_t>(100, 150), 0);
  EXPECT_TRUE(std::isnan(depth(masked, right)));
  Mesh low_cutoff = HalfClearSquare(AlphaMode::kMask);
  low_cutoff.materials[0].alpha_cutoff = 0.3F;
  EXPECT_THAT(At(RenderOrDie(low_cutoff, camera), right), IsColour(kWhite));
  const RenderedView blended = RenderOrDie(HalfClearSquare(AlphaMode::kBlend), camera);
  EXPECT_THAT(At(blended, left), IsColour(kWhite));
  EXPECT_THAT(At(blended, right), IsColour(cv::Vec3b(193, 193, 193)));  // 0.4 * 1 + 0.6 * 0.2158, linear
  EXPECT_NEAR(blended.mask.at<std::uint8_t>(100, 150), 102, 1);
  EXPECT_NEAR(depth(blended, left), 6, 1e-3);
  EXPECT_TRUE(std::isnan(depth(blended, right)));
}

TEST(Renderer, BlendedTrianglesAreDrawnBackToFront) {
  // Two half-transparent panes, red and blue, at two depths, in either order.
  const auto pane = [](const Eigen::Vector4f& colour) {
    Mesh square = SquareFacingBack();
    square.materials[0].alpha_mode = AlphaMode::kBlend;
    square.materials[0].base_colour = colour;
    return square;
  };
  Renderer renderer = MakeRenderer();
  const MeshId red = *renderer.Upload(pane({1, 0, 0, 0.5F}));
  const MeshId blue = *renderer.Upload(pane({0, 0, 1, 0.5F}));
  const Rigid3 nearer{Eigen::Quaterniond::Identity(), {-0.5, 0, 0}};
  for (const auto& instances : {std::vector<MeshInstance>{{red, {}}, {blue, nearer}}, {{blue, nearer}, {red, {}}}}) {
    const auto view = renderer.Render(instances, CameraAt(0, 90), kEven, {.background = 0});
    ASSERT_TRUE(view);
    EXPECT_THAT(Middle(*view), IsColour(cv::Vec3b(188, 0, 137)));  // 0.5 and 0.25, linear
    EXPECT_NEAR(view->mask.at<std::uint8_t>(100, 120), 191, 1);
  }
}

TEST(Renderer, OpaqueBlendedTrianglesOcclude) {
  // A tilted green plane whose centre is farther than that of the small red square occludes the square.
  Mesh plane = SquareFacingBack();
  for (Vector3f& p : plane.positions) p = Vector3f(p.y() > 0 ? -0.2F : 9.0F, p.y() > 0 ? 0.9F : -9.0F, p.z());
  Mesh square = SquareFacingBack();
  for (Vector3f& p : square.positions) p = Vector3f(0.5F, 0.7F + 0.1F * p.y(), 0.1F * p.z());
  plane.materials[0].base_colour = {0, 1, 0, 0.995F};
  square.materials[0].base_colour = {1, 0, 0, 0.995F};
  for (Mesh* mesh : {&plane, &square}) {
    mesh->materials[0].alpha_mode = AlphaMode::kBlend;
    mesh->materials[0].double_sided = true;
  }
  Renderer renderer = MakeRenderer();
  const std::vector<MeshInstance> scene = {{*renderer.Upload(plane), {}}, {*renderer.Upload(square), {}}};
  const PosedCamera camera = CameraAt(0, 90);
  const auto view = renderer.Render(scene, camera, kEven);
  ASSERT_TRUE(view);
  const Eigen::Vector2d at = *camera.pinhole.Project(camera.camera_from_world.Apply({0.5, 0.7, 0}));
  EXPECT_THAT(At(*view, at), IsColour(kGreen));
}

TEST(Renderer, InstancesOccludeEachOther) {
  Renderer renderer = MakeRenderer();
  const MeshId cube = *renderer.Upload(ColouredCube());
  const MeshId square = *renderer.Upload(SquareFacingBack());
  const Rigid3 left_and_turned{Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Vector3d::UnitZ())), {0, 1, 0}};
  const auto view = renderer.Render(
      std::vector<MeshInstance>{
          {square, {Eigen::Quaterniond::Identity(), {2, 0, 0}}}, {cube, {}}, {cube, left_and_turned}},
      CameraAt(0, 90, 2), kEven);
  ASSERT_TRUE(view);
  const auto instance = [&](int x, int y) { return view->instances.at<std::int32_t>(y, x); };
  EXPECT_EQ(instance(120, 100), 1);
  EXPECT_EQ(instance(75, 100), 2);
  EXPECT_EQ(instance(150, 100), 0);
  EXPECT_EQ(instance(2, 2), -1);
  EXPECT_THAT(At(*view, {75, 100}), IsColour(kGreen));  // rotated, it shows its front
}

TEST(Renderer, IsDeterministicAndStateless) {
  Renderer renderer = MakeRenderer();
  const MeshId cube = *renderer.Upload(ColouredCube());
  const std::vector<MeshInstance> scene = {{cube, {}}};
  const auto first = renderer.Render(scene, CameraAt(30, 40));
  PosedCamera other = CameraAt(200, 60);
  other.pinhole.width = 100;
  ASSERT_TRUE(renderer.Render(scene, other, kEven, {.supersampling = 1}));
  Renderer second_renderer = MakeRenderer();
  const MeshId second_cube = *second_renderer.Upload(ColouredCube());
  for (const auto& again : {renderer.Render(scene, CameraAt(30, 40)),
                            second_renderer.Render(std::vector<MeshInstance>{{second_cube, {}}}, CameraAt(30, 40))}) {
    ASSERT_TRUE(first && again);
    EXPECT_EQ(cv::norm(first->bgr, again->bgr, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(first->mask, again->mask, cv::NORM_INF), 0);
    EXPECT_EQ(std::memcmp(first->depth_m.data, again->depth_m.data, first->depth_m.total() * 4), 0);
  }
}

TEST(Renderer, RendersEmptySceneAndFromInsideAMesh) {
  Renderer renderer = MakeRenderer();
  const auto empty = renderer.Render({}, CameraAt(0, 0));
  ASSERT_TRUE(empty);
  EXPECT_EQ(cv::countNonZero(empty->mask), 0);
  EXPECT_THAT(Middle(*empty), IsColour(kGrey));
  Mesh room = ColouredCube();
  for (Material& material : room.materials) material.double_sided = true;
  PosedCamera within = CameraAt(0, 90);
  within.camera_from_world.translation.setZero();
  EXPECT_THAT(Middle(RenderOrDie(room, within)), IsColour(kGreen));
}

TEST(Renderer, BadInputIsRefused) {
  Renderer renderer = MakeRenderer();
  const MeshId cube = *renderer.Upload(ColouredCube());
  const std::vector<MeshInstance> scene = {{cube, {}}};
  const PosedCamera camera = CameraAt(0, 0);
  PosedCamera flat = camera;
  flat.pinhole.height = 0;
  EXPECT_FALSE(renderer.Render(scene, flat));
  PosedCamera blind = camera;
  blind.pinhole.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(renderer.Render(scene, blind));
  PosedCamera huge = camera;
  huge.pinhole.width = 1'000'000;
  EXPECT_THAT(renderer.Render(scene, huge).error().message, HasSubstr("at most"));
  EXPECT_FALSE(renderer.Render(scene, camera, {.sky = -1}));
  EXPECT_FALSE(renderer.Render(scene, camera, {.to_sun_in_world = {0, 0, 0}}));
  EXPECT_FALSE(renderer.Render(scene, camera, {}, {.background = 256}));
  renderer.Remove(cube);
  EXPECT_THAT(renderer.Render(scene, camera).error().message, HasSubstr("holds no such mesh"));
}

TEST(Renderer, RendersEveryExternalModel) {
  VICTORIOUS_DATA_OR_SKIP(folder, "models");
  Renderer renderer = MakeRenderer();
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".glb") continue;
    SCOPED_TRACE(entry.path().filename());
    const auto loaded = LoadMesh(entry.path());
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_THAT(loaded->warnings, ::testing::IsEmpty());
    const auto id = renderer.Upload(loaded->mesh);
    ASSERT_TRUE(id);
    const Sphere sphere = BoundingSphere(loaded->mesh);
    const auto camera =
        CameraForView({RadiansFromDegrees(135), RadiansFromDegrees(60)}, sphere,
                      {.distance_m = 10 * sphere.radius, .diameter_px = 150, .width_px = 160, .height_px = 160});
    ASSERT_TRUE(camera);
    const auto view = renderer.Render(std::vector<MeshInstance>{{*id, {}}}, *camera);
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_GT(cv::sum(view->mask)[0] / 255, 1000);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(view->bgr, mean, deviation, view->mask);
    EXPECT_GT(cv::norm(deviation), 10) << "no texture";
    renderer.Remove(*id);
  }
}

}  // namespace
}  // namespace victorious
