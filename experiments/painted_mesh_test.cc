#include "experiments/painted_mesh.h"

#include <array>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/render/renderer.h"

namespace victorious {
namespace {

// A box of 12 triangles around the origin, counter-clockwise seen from outside.
Mesh BoxMesh(const Eigen::Vector3f& half) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                                (i & 4) != 0 ? half.z() : -half.z());
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : kFaces) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  mesh.normals.resize(8, Eigen::Vector3f::UnitZ());
  mesh.uvs.resize(8, Eigen::Vector2f::Zero());
  mesh.materials = {{.name = "plain", .double_sided = true}};
  mesh.parts = {{0, 0, 12}};
  return mesh;
}

cv::Mat Patches(int width, int height) {
  Random random(3);
  cv::Mat image(height, width, CV_8UC3, cv::Scalar::all(90));
  for (int i = 0; i < 200; ++i) {
    const cv::Rect patch(static_cast<int>(random.Below(static_cast<std::uint32_t>(width))),
                         static_cast<int>(random.Below(static_cast<std::uint32_t>(height))), 24, 24);
    cv::rectangle(image, patch, cv::Scalar(random.Below(230), random.Below(230), random.Below(230)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 2);
  return image;
}

cv::Mat Render(const Mesh& mesh, const PosedCamera& camera, cv::Mat& mask) {
  Renderer renderer = Renderer::Create({.software = true}).value();
  const MeshInstance instance{.mesh = renderer.Upload(mesh).value(), .world_from_mesh = {}};
  Light even;
  even.sky = even.ground = 1;
  even.sun = 0;
  const RenderedView view = renderer.Render(std::span(&instance, 1), camera, even).value();
  cv::erode(view.mask == 255, mask, cv::Mat::ones(5, 5, CV_8U));
  return view.bgr;
}

TEST(ProjectTexture, ReproducesTheImageFromItsViewpoint) {
  const Mesh box = BoxMesh({0.3F, 0.2F, 0.1F});
  const Sphere sphere = BoundingSphere(box);
  const ViewFraming framing{.distance_m = 1.2, .diameter_px = 260, .width_px = 320, .height_px = 280};
  const PosedCamera camera = CameraForView({0.6, 0.9}, sphere, framing).value();
  const cv::Mat image = Patches(320, 280);
  const Mesh painted = ProjectTexture(box, image, camera).value();
  EXPECT_GT(painted.triangles.size(), 1000U) << "subdivided, so that perspective does not distort the texture";
  cv::Mat mask;
  const cv::Mat seen = Render(painted, camera, mask);
  ASSERT_GT(cv::countNonZero(mask), 10000);
  cv::Mat difference;
  cv::absdiff(seen, image, difference);
  const cv::Scalar mean = cv::mean(difference, mask);
  for (int channel = 0; channel < 3; ++channel) EXPECT_LT(mean[channel], 4);
}

TEST(ProjectTexture, SurfacesNotInTheImageAreUniform) {
  const Mesh box = BoxMesh({0.3F, 0.2F, 0.1F});
  const Sphere sphere = BoundingSphere(box);
  const ViewFraming framing{.distance_m = 1.2, .diameter_px = 260, .width_px = 320, .height_px = 280};
  const Mesh painted =
      ProjectTexture(box, Patches(320, 280), CameraForView({0.6, 0.9}, sphere, framing).value()).value();
  cv::Mat mask;
  const cv::Mat behind = Render(painted, CameraForView({0.6 + 3.14159, 2.2}, sphere, framing).value(), mask);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(behind, mean, deviation, mask);
  for (int channel = 0; channel < 3; ++channel) EXPECT_LT(deviation[channel], 2);
}

}  // namespace
}  // namespace victorious
