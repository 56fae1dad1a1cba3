#include "victorious/calibrate/motion_contradiction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "victorious/base/median.h"
#include "victorious/calibrate/motion_comparison.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Residuals, and the motion that they are of, averaged over each second.
struct Seconds {
  std::vector<Vector3d> seen;
  std::vector<Vector3d> residuals;
};

Seconds AverageSeconds(const MotionComparison& comparison, const ResidualSet& residual_set) {
  constexpr std::size_t kMinPairsInSecond = 5;
  std::map<std::int64_t, std::vector<std::size_t>> of_second;
  for (std::size_t k = 0; k < residual_set.pairs.size(); ++k)
    of_second[static_cast<std::int64_t>(std::floor(comparison.time_s(residual_set.pairs[k])))].push_back(k);
  Seconds seconds;
  for (const auto& [second, pairs] : of_second) {
    if (pairs.size() < kMinPairsInSecond) continue;
    Vector3d seen = Vector3d::Zero();
    Vector3d residual = Vector3d::Zero();
    for (const std::size_t k : pairs) {
      seen += comparison.measured(residual_set.pairs[k]) / static_cast<double>(pairs.size());
      residual += residual_set.residuals[k] / static_cast<double>(pairs.size());
    }
    seconds.seen.push_back(seen);
    seconds.residuals.push_back(residual);
  }
  return seconds;
}

// True if the median residual is a large part of the motion, and four of five seconds say so.
bool IsMissing(const std::vector<Vector3d>& residuals, const Vector3d& missing, double motion_px) {
  constexpr double kMinMissing_px = 0.5;
  constexpr double kMinMissingFraction = 0.5;
  constexpr double kMinAgreeing = 0.8;
  if (missing.norm() < std::max(kMinMissing_px, kMinMissingFraction * motion_px)) return false;
  const auto agreeing = std::ranges::count_if(
      residuals, [&](const Vector3d& residual) { return residual.dot(missing) >= missing.squaredNorm() / 2; });
  return static_cast<double>(agreeing) >= kMinAgreeing * static_cast<double>(residuals.size());
}

}  // namespace

std::optional<ContradictedMotion> FindContradiction(const ImageMotions& seen, const CameraTrajectory& cameras) {
  constexpr std::size_t kMinSeconds = 4;
  constexpr double kMinHeight_m = 1;
  constexpr double kMaxHeight_m = 6400;
  constexpr double kCoarseStep = 1.5;
  // A camera that circles turns by as much as it moves: of the motion that its way alone would cause, so much remains.
  constexpr double kFineStep = 1.02;
  // Of the whole motion: a yaw that is given once for a flight misses slow turns.
  constexpr double kMinTurnFraction = 0.1;
  if (seen.motions.size() < kMinPairs || cameras.states().empty()) return std::nullopt;
  const MotionComparison comparison(seen, cameras);
  const MotionComparison::Poses poses = comparison.PosesAt(0);
  Seconds best;
  Vector3d missing;
  double best_height_m = kMinHeight_m;
  const auto try_heights = [&](double from_m, double to_m, double step) {
    for (double height_m = from_m; height_m <= to_m; height_m *= step) {
      Seconds seconds = AverageSeconds(comparison, ComputeResiduals(comparison, poses, 1 / height_m));
      if (seconds.residuals.size() < kMinSeconds) continue;
      const Vector3d middle = Medians(seconds.residuals);
      if (!best.residuals.empty() && middle.norm() >= missing.norm()) continue;
      best = std::move(seconds);
      missing = middle;
      best_height_m = height_m;
    }
  };
  try_heights(kMinHeight_m, kMaxHeight_m, kCoarseStep);
  try_heights(best_height_m / kCoarseStep, best_height_m * kCoarseStep, kFineStep);
  if (best.residuals.empty()) return std::nullopt;
  const Vector3d moved = Medians(best.seen);
  const bool differs = IsMissing(best.residuals, missing, moved.norm());
  // The turn of the image does not depend on the height of the ground.
  std::vector<Vector3d> turns;
  for (const Vector3d& residual : best.residuals) turns.emplace_back(0, 0, residual.z());
  const bool turns_otherwise =
      IsMissing(turns, {0, 0, missing.z()}, std::max(std::abs(moved.z()), std::abs(moved.z() - missing.z()))) &&
      std::abs(missing.z()) >= kMinTurnFraction * std::max(moved.norm(), (moved - missing).norm());
  if (!differs && !turns_otherwise) return std::nullopt;
  std::vector<double> intervals_s;
  for (const ImageMotion& motion : seen.motions) intervals_s.push_back(motion.to_s - motion.from_s);
  const double interval_s = Median(std::move(intervals_s));
  return ContradictedMotion{.seen_px_s = moved / interval_s, .predicted_px_s = (moved - missing) / interval_s};
}

}  // namespace victorious
