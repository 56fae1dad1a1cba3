#include "victorious/search/pose/plane_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "victorious/geometry/homography.h"
#include "victorious/geometry/solvers/plane_maps.h"

namespace victorious {
namespace {

// Prior of the mixture: the pairs are the inliers of a similarity, most of them of this instance.
constexpr double kInlierFraction = 0.9;
// Rounds of the annealing. The standard deviation falls geometrically to the noise within the first kFallingRounds and
// stays there for the rest, in which the fit converges.
constexpr int kRounds = 8;
constexpr int kFallingRounds = 5;
// A map is implausible if it changes the outline's area against the similarity's by more than this factor. Chosen: a
// plane that is turned away by 70 degrees shrinks by it.
constexpr double kMaxAreaChange = 3.0;
// Minimum homogeneous coordinate of an outline's corner: near 0 it lies on the horizon.
constexpr double kMinHomogeneous = 0.1;
// Minimum number of pairs: twice the minimal sample (3) for an affine map; of a homography (4) more, since its two
// perspective parameters are sensitive to noise. The similarity must always be possible.
constexpr std::size_t kMinSimilarityPairs = 2;
constexpr std::size_t kMinAffinePairs = 6;
constexpr std::size_t kMinHomographyPairs = 10;

using Solve = std::function<std::optional<Eigen::Matrix3d>(std::span<const PointPair>, std::span<const double>)>;

struct Kind {
  int parameters;
  std::size_t min_pairs;
  Solve solve;
};

struct Fit {
  Eigen::Matrix3d map;
  double log_likelihood;
};

// E step: writes the posterior inlier probabilities under a Gaussian-uniform mixture to `weights`.
// @return the log likelihood of the pairs
double Posterior(std::span<const PointPair> pairs, const Eigen::Matrix3d& map, double sigma, double area,
                 std::vector<double>& weights) {
  const double density = kInlierFraction / (2 * std::numbers::pi * sigma * sigma);
  const double outlier = (1 - kInlierFraction) / area;
  double log_likelihood = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double squared = (ApplyHomography(map, pairs[i].source) - pairs[i].target).squaredNorm();
    const double inlier = density * std::exp(-0.5 * squared / (sigma * sigma));
    weights[i] = inlier / (inlier + outlier);
    log_likelihood += std::log(inlier + outlier);
  }
  return log_likelihood;
}

std::optional<Fit> FitByAnnealing(std::span<const PointPair> pairs, const Kind& kind, const Eigen::Matrix3d& start,
                                  double start_sigma, double noise, double area) {
  Fit fit{start, 0};
  std::vector<double> weights(pairs.size());
  for (int round = 0; round < kRounds; ++round) {
    const double progress = static_cast<double>(round) / kFallingRounds;
    const double sigma = std::max(noise, start_sigma * std::pow(noise / start_sigma, progress));
    Posterior(pairs, fit.map, sigma, area, weights);
    const std::optional<Eigen::Matrix3d> map = kind.solve(pairs, weights);
    if (!map) return std::nullopt;
    fit.map = *map;
  }
  fit.log_likelihood = Posterior(pairs, fit.map, noise, area, weights);
  return fit;
}

// True if the projected outline is plausible: not mirrored, in front of the horizon, convex if it was convex, and its
// area within a factor of three of the similarity's.
bool IsShapePlausible(const Eigen::Matrix3d& map, const Similarity2& similarity, const Polygon& outline) {
  const bool before_horizon = std::ranges::all_of(
      outline, [&](const Eigen::Vector2d& corner) { return (map * corner.homogeneous()).z() > kMinHomogeneous; });
  if (!before_horizon) return false;
  const Polygon projected = ProjectPolygon(map, outline);
  const double ratio = SignedArea(projected) / (SignedArea(outline) * similarity.scale * similarity.scale);
  if (!(ratio > 1 / kMaxAreaChange && ratio < kMaxAreaChange)) return false;
  return IsConvex(projected) || !IsConvex(outline);
}

}  // namespace

Eigen::Matrix3d RefinePlane(std::span<const PointPair> pairs, const Similarity2& start, double start_sigma_px,
                            double noise_px, double scene_area_px2, const Polygon& outline) {
  const auto solve_similarity = [](std::span<const PointPair> p,
                                   std::span<const double> w) -> std::optional<Eigen::Matrix3d> {
    const auto similarity = SolveSimilarity(p, w);
    if (!similarity) return std::nullopt;
    return similarity->Matrix();
  };
  const std::array<Kind, 3> kinds = {Kind{4, kMinSimilarityPairs, solve_similarity},
                                     Kind{6, kMinAffinePairs, &SolveAffine},
                                     Kind{8, kMinHomographyPairs, &SolveHomography}};
  Eigen::Matrix3d best = start.Matrix();
  double best_criterion = -std::numeric_limits<double>::infinity();
  for (const Kind& kind : kinds) {
    if (pairs.size() < kind.min_pairs) break;
    const auto fit = FitByAnnealing(pairs, kind, start.Matrix(), start_sigma_px, noise_px, scene_area_px2);
    if (!fit || !IsShapePlausible(fit->map, start, outline)) continue;
    const double criterion =
        fit->log_likelihood - 0.5 * kind.parameters * std::log(2.0 * static_cast<double>(pairs.size()));
    if (criterion > best_criterion) {
      best_criterion = criterion;
      best = fit->map;
    }
  }
  return best;
}

}  // namespace victorious
