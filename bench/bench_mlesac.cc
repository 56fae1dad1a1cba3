#include <string>

#include <opencv2/calib3d.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/geometry/robust/mlesac.h"
#include "victorious/geometry/robust/similarity_estimator.h"
#include "victorious/search/grammar/cascade.h"

namespace victorious::bench {
namespace {

constexpr double kNoisePx = 1.5;

Result CompareWithRansac(std::string name, const std::vector<PointPair>& pairs, const Settings& settings) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const PointPair& pair : pairs) {
    from.emplace_back(static_cast<float>(pair.source.x()), static_cast<float>(pair.source.y()));
    to.emplace_back(static_cast<float>(pair.target.x()), static_cast<float>(pair.target.y()));
  }
  const MlesacOptions mlesac{.outlier_area_px2 = 640.0 * 480.0};
  const auto estimate = [&] { return Mlesac(SimilarityEstimator(pairs, {.noise_px = kNoisePx}), mlesac); };
  const Implementation ours = {"victorious", [&] {
                                 const auto found = estimate();
                                 return found ? found->model.scale : 0;
                               }};
  const Implementation opencv = {"opencv", [&] {
                                   const cv::Mat map = cv::estimateAffinePartial2D(
                                       from, to, cv::noArray(), cv::RANSAC, 2.5 * kNoisePx, 500, mlesac.confidence);
                                   return map.empty() ? 0 : map.at<double>(0, 0);
                                 }};
  Result result = Compare(std::move(name), ours, {opencv}, settings.effort());
  const auto found = estimate();
  result.figures = {{"matches", static_cast<double>(pairs.size())},
                    {"inlier_fraction", found ? found->gamma : 0},
                    {"hypotheses", found ? found->hypotheses : 0}};
  return result;
}

}  // namespace

std::vector<Result> BenchMlesac(const Settings& settings) {
  const MatchedScene cluttered = SimulateMatches(12, 68, /*seed=*/1);
  const MatchSet left = FilterByGrammar(cluttered.scene, cluttered.model, cluttered.matches, {}).third;
  const MatchedScene plain = SimulateMatches(60, 20, /*seed=*/2);
  return {CompareWithRansac("mlesac", MakePointPairs(cluttered, left), settings),
          CompareWithRansac("mlesac_80", MakePointPairs(plain, plain.matches), settings)};
}

}  // namespace victorious::bench
