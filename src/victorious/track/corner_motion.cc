#include "victorious/track/corner_motion.h"

#include <vector>

#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"

namespace victorious {
namespace {

constexpr int kMaxHypotheses = 200;  // at 30 % inliers a pair of them is drawn with a probability above 1 - 1e-8

}  // namespace

std::vector<PointPair> TrackCorners(const FlowPyramid& from, const FlowPyramid& to,
                                    std::span<const Eigen::Vector2d> corners, double image_scale) {
  const auto followed = TrackPointsForwardBackward(from, to, corners, corners);
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (followed[i]) pairs.push_back({corners[i] / image_scale, *followed[i] / image_scale});
  }
  return pairs;
}

std::optional<Similarity2> FitCornerMotion(std::span<const PointPair> pairs, const CornerMotionOptions& options) {
  if (pairs.size() < kMinMotionInliers) return std::nullopt;
  const SimilarityEstimator estimator(pairs, {.noise_px = options.noise_px});
  const auto result =
      Mlesac(estimator, {.outlier_area_px2 = options.outlier_area_px2, .max_hypotheses = kMaxHypotheses});
  if (!result || result->gamma * static_cast<double>(pairs.size()) < kMinMotionInliers) return std::nullopt;
  return result->model;
}

std::optional<Similarity2> EstimateCornerMotion(const FlowPyramid& from, const FlowPyramid& to,
                                                std::span<const Eigen::Vector2d> corners,
                                                const CornerMotionOptions& options) {
  return FitCornerMotion(TrackCorners(from, to, corners, options.image_scale), options);
}

}  // namespace victorious
