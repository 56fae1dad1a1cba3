// Compares Relight() with the renderer under the same sun.
#include "victorious/object/render/relight.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/cad_tools.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/view_sphere.h"

namespace victorious {
namespace {

const std::array<Eigen::Vector3f, 6> kGreys = {Eigen::Vector3f::Constant(0.3F), Eigen::Vector3f::Constant(0.4F),
                                               Eigen::Vector3f::Constant(0.5F), Eigen::Vector3f::Constant(0.6F),
                                               Eigen::Vector3f::Constant(0.2F), Eigen::Vector3f::Constant(0.35F)};
const ViewDirection kSun = {RadiansFromDegrees(60), RadiansFromDegrees(40)};

// A tower on a plate.
class Towered {
 public:
  Towered() {
    instances_ = {{*renderer_.Upload(testing::Box({-2, -2, -0.3F}, {2, 2, 0}, kGreys)), {}},
                  {*renderer_.Upload(testing::Box({-0.5F, -0.4F, 0}, {0.5F, 0.4F, 2}, kGreys)), {}}};
  }

  RenderedView Render(const ViewDirection& direction, const Light& light) {
    return *renderer_.Render(instances_, CameraOf(direction), light);
  }
  PosedDepthMap Surface(const ViewDirection& direction) {
    return {CameraOf(direction), Render(direction, Light()).depth_m};
  }
  static PosedCamera CameraOf(const ViewDirection& direction) {
    return *CameraForView(direction, {{0, 0, 0.8}, 3},
                          {.distance_m = 36, .diameter_px = 300, .width_px = 330, .height_px = 330});
  }

 private:
  Renderer renderer_ = *Renderer::Create({.software = true});
  std::vector<MeshInstance> instances_;
};

Light Sunny() {
  return {.sky = 0.4,
          .ground = 0.25,
          .sun = 0.9,
          .to_sun_in_world = DirectionToCamera(kSun),
          .shadows = true,
          .shadow_softness_m = 0.05};
}

cv::Mat GreyOf(const RenderedView& view) {
  cv::Mat grey;
  cv::cvtColor(view.bgr, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

TEST(Relight, MatchesTheRendererUnderTheSameSun) {
  Towered scene;
  for (const double azimuth_deg : {0.0, 100.0, 250.0}) {
    const ViewDirection from = {RadiansFromDegrees(azimuth_deg), RadiansFromDegrees(40)};
    const RenderedView soft = scene.Render(from, Light());
    const cv::Mat wanted = GreyOf(scene.Render(from, Sunny()));
    const cv::Mat relit = Relight(GreyOf(soft), scene.Surface(from), Light(), Sunny(), scene.Surface(kSun));
    const cv::Mat mask = soft.mask == 255;
    cv::Mat off;
    cv::absdiff(relit, wanted, off);
    cv::Mat before;
    cv::absdiff(GreyOf(soft), wanted, before);
    ASSERT_GT(cv::countNonZero(mask), 10000);
    EXPECT_LT(cv::mean(off, mask)[0], 4) << azimuth_deg;  // edges of shadows and of the tower
    EXPECT_LT(cv::mean(off, mask)[0], 0.3 * cv::mean(before, mask)[0]) << azimuth_deg;
  }
}

TEST(Relight, KeepsTheBackground) {
  Towered scene;
  const ViewDirection from = {0, RadiansFromDegrees(30)};
  const RenderedView soft = scene.Render(from, Light());
  const cv::Mat relit = Relight(GreyOf(soft), scene.Surface(from), Light(), Sunny(), scene.Surface(kSun));
  cv::Mat off;
  cv::absdiff(relit, GreyOf(soft), off);
  EXPECT_EQ(cv::countNonZero(off & (soft.mask == 0)), 0);
}

}  // namespace
}  // namespace victorious
