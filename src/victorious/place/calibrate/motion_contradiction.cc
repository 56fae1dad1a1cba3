#include "victorious/place/calibrate/motion_contradiction.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "victorious/base/median.h"
#include "victorious/place/calibrate/motion_comparison.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

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
  // Of the whole motion: a yaw that is given once for a flight misses slow turns.
  constexpr double kMinTurnFraction = 0.1;
  if (seen.motions.size() < kMinPairs || cameras.states().empty()) return std::nullopt;
  const MotionComparison comparison(seen, cameras);
  const MotionComparison::Poses poses = comparison.PosesAt(0);
  const auto best =
      FindBestHeight(comparison, poses, [](const SecondMotions& seconds) { return Medians(seconds.residuals).norm(); });
  if (!best) return std::nullopt;
  const SecondMotions& seconds = best->seconds;
  const Vector3d missing = Medians(seconds.residuals);
  const Vector3d moved = Medians(seconds.seen);
  const bool differs = IsMissing(seconds.residuals, missing, moved.norm());
  // The turn of the image does not depend on the height of the ground.
  std::vector<Vector3d> turns;
  for (const Vector3d& residual : seconds.residuals) turns.emplace_back(0, 0, residual.z());
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
