#include "victorious/track/camera_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/track/corner_motion.h"

namespace victorious {
namespace {

constexpr int kLongSide_px = 400;        // sufficient for the global motion, at a fraction of the cost
constexpr double kCornerNoise_px = 1.0;  // of the scaled-down frame
constexpr double kMaxScaleChange = 1.5;  // between consecutive frames

}  // namespace

std::optional<Similarity2> ImageMotionEstimator::Step(const cv::Mat& grey) {
  const double factor = std::min(1.0, kLongSide_px / static_cast<double>(std::max(grey.cols, grey.rows)));
  const auto shrunk = [&](int length_px) { return std::max(1, static_cast<int>(std::lround(length_px * factor))); };
  cv::Mat small;
  cv::resize(grey, small, {shrunk(grey.cols), shrunk(grey.rows)}, 0, 0, cv::INTER_AREA);
  FlowPyramid now(small);
  const std::optional<FlowPyramid> before = std::exchange(before_, now);
  corners_.clear();
  if (!before || before->grey().size() != small.size()) return std::nullopt;

  const Box whole{0, 0, static_cast<double>(small.cols), static_cast<double>(small.rows)};
  const std::vector<Eigen::Vector2d> corners = DetectCorners(before->grey(), BoxCorners(whole), kMotionCorners);
  corners_ = TrackCorners(*before, now, corners, factor);
  const auto motion = FitCornerMotion(corners_, {.image_scale = factor,
                                                 .noise_px = kCornerNoise_px / factor,
                                                 .outlier_area_px2 = static_cast<double>(grey.total())});
  if (!motion || std::abs(std::log(motion->scale)) >= std::log(kMaxScaleChange)) return std::nullopt;
  return motion;
}

}  // namespace victorious
