#include "victorious/object/model/view_appearance.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {

ViewAppearance SampleTemplatePoints(const ViewSurface& surface, double shrink) {
  constexpr double kRim_px = 3.0;  // scene pixels; excludes mixed pixels and outline errors
  constexpr double kPoints = 300;
  constexpr std::size_t kMinPoints = 40;
  const cv::Mat& depth_m = surface.depth_map.depth_m;
  const cv::Mat mask = depth_m == depth_m;  // not NaN
  const int rim = std::max(1, static_cast<int>(std::lround(kRim_px * shrink)));
  cv::Mat inside;
  cv::erode(mask, inside, cv::Mat::ones(2 * rim + 1, 2 * rim + 1, CV_8U));

  // Gaussian mean over object pixels only (normalised convolution).
  cv::Mat weight;
  mask.convertTo(weight, CV_32F, 1 / 255.0);
  cv::Mat sum;
  surface.grey.convertTo(sum, CV_32F);
  sum = sum.mul(weight);
  const double blur_px = std::max(0.5, kAppearanceBlur_px * shrink);
  cv::GaussianBlur(sum, sum, {}, blur_px);
  cv::GaussianBlur(weight, weight, {}, blur_px);

  const PosedCamera& camera = surface.depth_map.camera;
  const Rigid3 model_from_camera = camera.camera_from_world.Inverse();
  const int step = std::max(1, static_cast<int>(std::sqrt(cv::countNonZero(inside) / kPoints)));
  ViewAppearance appearance{.points = {}, .camera_from_model = camera.camera_from_world.rotation};
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int row = 0; row < inside.rows; row += step) {
    for (int column = 0; column < inside.cols; column += step) {
      if (inside.at<std::uint8_t>(row, column) == 0) continue;
      const Eigen::Vector3d position = model_from_camera.Apply(static_cast<double>(depth_m.at<float>(row, column)) *
                                                               camera.pinhole.Unproject({column + 0.5, row + 0.5}));
      appearance.points.push_back({position.cast<float>(), sum.at<float>(row, column) / weight.at<float>(row, column)});
      middle += position;
    }
  }
  if (appearance.points.size() < kMinPoints) return {};
  middle /= static_cast<double>(appearance.points.size());
  for (SurfaceSample& point : appearance.points) point.position_m -= middle.cast<float>();
  const Eigen::Vector3d depth_map = camera.camera_from_world.Apply(middle);
  appearance.centre_px = {camera.pinhole.fx * depth_map.x() / depth_map.z() + camera.pinhole.cx,
                          camera.pinhole.fy * depth_map.y() / depth_map.z() + camera.pinhole.cy};
  appearance.pixels_per_m = camera.pinhole.fx / depth_map.z();
  return appearance;
}

}  // namespace victorious
