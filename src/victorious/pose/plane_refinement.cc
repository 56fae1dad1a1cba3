#include "victorious/pose/plane_refinement.h"

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

using Solve = std::function<std::optional<Eigen::Matrix3d>(std::span<const PointPair>, std::span<const double>)>;

struct Kind {
  int parameters;
  std::size_t min_pairs;  ///< more than the minimal sample, so that the fit is overdetermined (similarity: minimal)
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
  constexpr double kInlierFraction = 0.9;  // prior: the pairs are the inliers of a similarity
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
  constexpr int kRounds = 8;
  Fit fit{start, 0};
  std::vector<double> weights(pairs.size());
  for (int round = 0; round < kRounds; ++round) {
    const double progress = static_cast<double>(round) / (kRounds - 3);
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
  constexpr double kMaxAreaChange = 3.0;
  const bool before_horizon = std::ranges::all_of(
      outline, [&](const Eigen::Vector2d& corner) { return (map * corner.homogeneous()).z() > 0.1; });
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
  const std::array<Kind, 3> kinds = {Kind{4, 2, solve_similarity}, Kind{6, 6, &SolveAffine},
                                     Kind{8, 10, &SolveHomography}};
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
