#include "victorious/track/camera_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"

namespace victorious {
namespace {

constexpr int kLongSide_px = 400;  // sufficient for the global motion, at a fraction of the cost
constexpr int kPoints = 80;
constexpr std::size_t kMinPoints = 12;
constexpr double kMaxScaleChange = 1.5;  // between consecutive frames

}  // namespace

std::optional<Similarity2> ImageMotionEstimator::Step(const cv::Mat& grey) {
  const double factor = std::min(1.0, kLongSide_px / static_cast<double>(std::max(grey.cols, grey.rows)));
  const auto shrunk = [&](int length_px) { return std::max(1, static_cast<int>(std::lround(length_px * factor))); };
  cv::Mat small;
  cv::resize(grey, small, {shrunk(grey.cols), shrunk(grey.rows)}, 0, 0, cv::INTER_AREA);
  const TrackOptions options;
  FlowPyramid now(small, options);
  const std::optional<FlowPyramid> before = std::exchange(before_, now);
  if (!before || before->grey().size() != small.size()) return std::nullopt;

  const Box whole{0, 0, static_cast<double>(small.cols), static_cast<double>(small.rows)};
  const std::vector<Eigen::Vector2d> points = DetectCorners(before->grey(), BoxCorners(whole), kPoints);
  const std::vector<std::optional<Eigen::Vector2d>> followed =
      TrackPointsForwardBackward(*before, now, points, points, options);
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (followed[i]) pairs.push_back({points[i] / factor, *followed[i] / factor});
  }
  if (pairs.size() < kMinPoints) return std::nullopt;
  const SimilarityEstimator estimator(pairs, {.noise_px = 1.0 / factor});
  const auto result = Mlesac(estimator, {.outlier_area_px2 = static_cast<double>(grey.total()), .max_hypotheses = 200});
  if (!result || result->gamma * static_cast<double>(pairs.size()) < kMinPoints) return std::nullopt;
  if (std::abs(std::log(result->model.scale)) >= std::log(kMaxScaleChange)) return std::nullopt;
  return result->model;
}

}  // namespace victorious
