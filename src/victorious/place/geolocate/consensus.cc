#include "victorious/place/geolocate/consensus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "victorious/base/random.h"
#include "victorious/geometry/robust/sample_count.h"
#include "victorious/place/geolocate/linear_place.h"

namespace victorious {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;

// The rays as a structure of arrays, so that the evaluation is vectorised.
class FrustumTable {
 public:
  explicit FrustumTable(std::span<const Ray> rays) : columns_(static_cast<Index>(rays.size()), kColumns) {
    for (Index i = 0; i < columns_.rows(); ++i) {
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      columns_.row(i) << ray.time_s, ray.camera.x(), ray.camera.y(), ray.camera.z(), ray.forward.x(), ray.forward.y(),
          ray.forward.z(), ray.frustum.base_m2, ray.frustum.slope, ray.frustum.nearest_m, ray.frustum.farthest_m;
    }
  }

  /// The MSAC cost over all rays, or infinity as soon as it exceeds `max_cost`.
  [[nodiscard]] double Cost(const Motion& motion, double max_cost) const {
    constexpr Index kBlock = 128;
    double cost = 0;
    for (Index first = 0; first < columns_.rows(); first += kBlock) {
      cost += BlockCosts<kBlock>(motion, first, std::min(kBlock, columns_.rows() - first)).sum();
      if (cost > max_cost) return std::numeric_limits<double>::infinity();
    }
    return cost;
  }

 private:
  static constexpr Index kColumns = 11;

  template <int MaxRows>
  [[nodiscard]] Eigen::Array<double, Eigen::Dynamic, 1, 0, MaxRows, 1> BlockCosts(const Motion& motion, Index first,
                                                                                  Index count) const {
    using Column = Eigen::Array<double, Eigen::Dynamic, 1, 0, MaxRows, 1>;
    const auto column = [&](Index c) { return columns_.col(c).segment(first, count); };
    const Column x = motion.place.x() + motion.velocity.x() * column(0) - column(1);
    const Column y = motion.place.y() + motion.velocity.y() * column(0) - column(2);
    const Column z = motion.place.z() + motion.velocity.z() * column(0) - column(3);
    const Column along = x * column(4) + y * column(5) + z * column(6);
    const Column along2 = along.square();
    const Column off2 = x.square() + y.square() + z.square() - along2;
    const Column cost_fraction = off2 / (column(7) + along2 * column(8));
    // above 0: outside the frustum's distance range, or behind the camera
    const Column outside_m = (column(9) - along).max(along - column(10));
    return (outside_m > 0).select(1.0, cost_fraction.min(1.0).max(0.0));
  }

  Eigen::Array<double, Eigen::Dynamic, kColumns> columns_;
};

std::vector<bool> FindInliers(std::span<const Ray> rays, const Motion& motion) {
  std::vector<bool> inliers(rays.size());
  std::transform(rays.begin(), rays.end(), inliers.begin(), [&](const Ray& ray) { return InFrustum(ray, motion); });
  return inliers;
}

struct MotionCandidate {
  Motion motion;
  double cost = std::numeric_limits<double>::infinity();
};

// Refits to the inliers while the cost falls.
void Refit(std::span<const Ray> rays, const FrustumTable& table, bool moving, MotionCandidate& candidate) {
  constexpr int kMaxRounds = 5;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto motion = SolveLinear(rays, FindInliers(rays, candidate.motion), moving);
    if (!motion) return;
    const double cost = table.Cost(*motion, candidate.cost);
    if (!(cost < candidate.cost)) return;
    candidate = {*motion, cost};
  }
}

class Sampler {
 public:
  Sampler(std::span<const Ray> rays, bool moving, std::uint64_t seed)
      : rays_(rays), size_(std::min<std::size_t>(moving ? 3 : 2, rays.size())), random_(seed), system_(moving) {}

  [[nodiscard]] std::size_t size() const { return size_; }

  /// The solution of a random sample, if it lies in the frustum of each sampled ray.
  std::optional<Motion> Draw() {
    std::array<std::uint32_t, 3> chosen{};
    system_.Clear();
    for (std::size_t k = 0; k < size_; ++k) {
      const auto end = chosen.begin() + static_cast<std::ptrdiff_t>(k);
      do {
        chosen[k] = random_.Below(static_cast<std::uint32_t>(rays_.size()));
      } while (std::find(chosen.begin(), end, chosen[k]) != end);
      system_.Add(rays_[chosen[k]]);
    }
    auto motion = system_.Solve();
    if (!motion) return std::nullopt;
    for (std::size_t k = 0; k < size_; ++k) {
      if (!InFrustum(rays_[chosen[k]], *motion)) return std::nullopt;
    }
    return motion;
  }

 private:
  std::span<const Ray> rays_;
  std::size_t size_;
  Random random_;
  NormalEquations system_;
};

// RANSAC stops when an outlier-free sample has been drawn with this probability.
constexpr double kConfidence = 0.9999;

// An outlier-free sample may be degenerate (nearly parallel rays), so that a minimum number of samples is drawn for any
// inlier fraction. Chosen, not fitted; consensus_test.cc checks the reliability that follows.
constexpr double kMinSamples = 150;

}  // namespace

std::optional<Consensus> FindConsensus(std::span<const Ray> rays, const LocateOptions& options) {
  const bool moving = options.motion == MotionModel::kVelocity;
  const FrustumTable table(rays);
  Sampler sampler(rays, moving, options.seed);
  MotionCandidate best;
  double needed = options.max_hypotheses;
  int num_drawn = 0;
  for (; num_drawn < options.max_hypotheses && num_drawn < needed; ++num_drawn) {
    const auto motion = sampler.Draw();
    if (!motion) continue;
    MotionCandidate candidate{*motion, table.Cost(*motion, best.cost)};
    if (!(candidate.cost < best.cost)) continue;
    Refit(rays, table, moving, candidate);
    best = candidate;
    const double inlier_fraction = 1 - best.cost / static_cast<double>(rays.size());  // lower bound
    needed = std::max(kMinSamples, SamplesNeeded(inlier_fraction, sampler.size(), kConfidence));
  }
  if (!std::isfinite(best.cost)) return std::nullopt;
  return Consensus{best.motion, FindInliers(rays, best.motion), num_drawn};
}

}  // namespace victorious
