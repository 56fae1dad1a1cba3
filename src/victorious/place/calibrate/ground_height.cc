#include "victorious/place/calibrate/ground_height.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/place/calibrate/motion_comparison.h"
#include "victorious/place/calibrate/telemetry_noise.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// What stands on the ground, and ground that is not level; of the depth.
constexpr double kReliefSigma = 0.01;
constexpr double kMaxSigma = 0.15;  // of the depth

double MeanNorm(const std::vector<Vector3d>& values) {
  double sum = 0;
  for (const Vector3d& value : values) sum += value.norm();
  return sum / static_cast<double>(values.size());
}

double MedianNorm(const std::vector<Vector3d>& values) {
  std::vector<double> norms;
  for (const Vector3d& value : values) norms.push_back(value.norm());
  return Median(std::move(norms));
}

// Huber's loss over the seconds, minimised by the logarithm of 1 / depth.
class DepthFit {
 public:
  DepthFit(const MotionComparison& comparison, const MotionComparison::Poses& poses, double per_m)
      : comparison_(comparison), poses_(poses), per_m_(per_m) {}

  // False if the motion of the camera does not determine it.
  bool Refine() {
    constexpr int kRounds = 15;
    constexpr double kMaxStep = 0.1;
    for (int round = 0; round < kRounds; ++round) {
      if (!Linearise()) return false;
      const double step = gradient_ / information_;
      if (!std::isfinite(step)) return false;
      per_m_ *= std::exp(std::clamp(step, -kMaxStep, kMaxStep));
    }
    return Linearise() && information_ > 0;
  }

  [[nodiscard]] double per_m() const { return per_m_; }

  // Of the logarithm, by seconds as independent blocks; with what telemetry leaves unexplained in all of them.
  [[nodiscard]] double Sigma() const {
    const auto blocks = static_cast<double>(residuals_.size());
    const double random = std::sqrt(blocks / (blocks - 1) * block_squares_) / information_;
    return std::hypot(random, Medians(residuals_).norm() / MedianNorm(slopes_), kReliefSigma);
  }

  // What the camera's way adds to the motion from frame to frame, px. It is nearly proportional to 1 / depth.
  [[nodiscard]] double ShiftByWay() const { return MedianNorm(slopes_); }

 private:
  [[nodiscard]] std::vector<Vector3d> ResidualsAt(double per_m) const {
    return AverageSeconds(comparison_, ComputeResiduals(comparison_, poses_, per_m)).residuals;
  }

  // Residuals, their slopes by the logarithm, and the equation for its step; false if the horizon comes into view.
  bool Linearise() {
    constexpr double kStep = 1e-3;
    constexpr double kHuber = 2;
    constexpr double kMinScale_px = 0.05;
    residuals_ = ResidualsAt(per_m_);
    const std::vector<Vector3d> nearer = ResidualsAt(per_m_ * std::exp(kStep));
    if (residuals_.size() < 2 || nearer.size() != residuals_.size()) return false;
    slopes_.clear();
    for (std::size_t i = 0; i < residuals_.size(); ++i) slopes_.emplace_back((residuals_[i] - nearer[i]) / kStep);
    Vector3d scales_px;
    for (int c = 0; c < 3; ++c) {
      std::vector<double> sizes;
      for (const Vector3d& residual : residuals_) sizes.push_back(std::abs(residual[c]));
      scales_px[c] = std::max(kMinScale_px, kMadToSigma * Median(std::move(sizes)));
    }
    gradient_ = information_ = block_squares_ = 0;
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      double block = 0;
      for (int c = 0; c < 3; ++c) {
        const double slope = slopes_[i][c] / scales_px[c];
        const double residual = residuals_[i][c] / scales_px[c];
        const double weight = HuberWeight(residual, kHuber);
        information_ += weight * slope * slope;
        block += weight * slope * residual;
      }
      gradient_ += block;
      block_squares_ += block * block;
    }
    return true;
  }

  const MotionComparison& comparison_;
  const MotionComparison::Poses& poses_;
  double per_m_;
  std::vector<Vector3d> residuals_;  // one a second, as slopes_
  std::vector<Vector3d> slopes_;
  double gradient_ = 0;
  double information_ = 0;
  double block_squares_ = 0;
};

// True if noise of places is a large part of the way in a second. It adds to the way, as greater depth does.
bool IsWayTooNoisy(const ImageMotions& seen, const CameraTrajectory& cameras) {
  constexpr double kMaxPlaceFraction = 0.2;
  const TangentPlane plane(cameras.states().front().place);
  std::vector<double> ways_m;
  for (double time_s = seen.motions.front().from_s; time_s + 1 <= seen.motions.back().to_s; ++time_s) {
    const auto from = cameras.At(time_s);
    const auto to = cameras.At(time_s + 1);
    if (!from || !to) continue;
    ways_m.push_back((plane.EnuFromGeodetic(to->place) - plane.EnuFromGeodetic(from->place)).norm());
  }
  return std::numbers::sqrt2 * EstimateNoise(cameras).place_m > kMaxPlaceFraction * MedianOr(std::move(ways_m), 0);
}

}  // namespace

std::optional<GroundHeight> EstimateGroundHeight(const ImageMotions& seen, const CameraTrajectory& cameras) {
  constexpr double kMinShift_px = 0.3;  // from frame to frame
  if (seen.motions.size() < kMinPairs || cameras.states().empty()) return std::nullopt;
  const VerticalDatum datum = cameras.states().front().datum;
  const bool has_heights =
      datum != VerticalDatum::kUnknown &&
      std::ranges::all_of(cameras.states(), [&](const CameraState& state) { return state.datum == datum; });
  if (!has_heights || IsWayTooNoisy(seen, cameras)) return std::nullopt;
  const MotionComparison comparison(seen, cameras);
  const MotionComparison::Poses poses = comparison.PosesAt(0);
  const auto start =
      FindBestHeight(comparison, poses, [](const SecondMotions& seconds) { return MeanNorm(seconds.residuals); });
  if (!start) return std::nullopt;
  DepthFit fit(comparison, poses, start->per_m);
  if (!fit.Refine() || fit.ShiftByWay() < kMinShift_px) return std::nullopt;
  const double sigma = fit.Sigma();
  if (!(sigma <= kMaxSigma)) return std::nullopt;
  const auto known = std::ranges::find_if(poses, [](const auto& pair) { return pair.has_value(); });
  return GroundHeight{.height_m = comparison.GroundAltitude((*known)->first.place, fit.per_m()),
                      .sigma_m = sigma / fit.per_m(),
                      .datum = datum};
}

}  // namespace victorious
