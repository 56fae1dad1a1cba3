#include "victorious/place/associate/heading_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/agreed_error.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMinLines = 10;
constexpr std::size_t kMaxLines = 60;                    // of a tracklet: more change little
constexpr double kMinTurn_rad = RadiansFromDegrees(25);  // of the lines of one tracklet
constexpr double kMaxError_rad = RadiansFromDegrees(20);
constexpr double kMinError_rad = RadiansFromDegrees(1.5);  // of a flight: three times the usual one
constexpr double kAgreement_rad = RadiansFromDegrees(0.7);
constexpr double kMaxSigma_rad = RadiansFromDegrees(0.5);  // of a tracklet's angle

// Standard deviation of a line, at least that of the object's centre, which differs from view to view.
constexpr double kMinSigma_rad = RadiansFromDegrees(0.2);

// A fit is one of lines that meet if the median of its residuals is within this many standard deviations.
constexpr double kMaxMedianSigmas = 2;

// Of an object that moves: a prior that keeps the fit of a camera that flies straight from being singular.
constexpr double kSigmaSpeed_m_s = 30;

// Errors of neighbouring lines are correlated, of about ten of them.
constexpr double kCorrelated = 10;

// A steady level motion explains the lines as well as an angle does if its cost is no more than this above, in units of
// chi^2.
constexpr double kAmbiguous = 10;

struct Line {
  double time_s = 0;  // since the middle of the tracklet
  Vector3d camera;    // ENU, m
  double azimuth_rad = 0;
  double elevation_rad = 0;
  double sigma_rad = 0;

  [[nodiscard]] Vector3d Direction(double error_rad) const {
    const double azimuth = azimuth_rad - error_rad;
    const double level = std::cos(elevation_rad);
    return {level * std::sin(azimuth), level * std::cos(azimuth), std::sin(elevation_rad)};
  }
};

std::vector<Line> LinesOf(const ObservedTracklet& tracklet) {
  const std::vector<BearingObservation>& observations = tracklet.observations;
  if (observations.size() < kMinLines) return {};
  const TangentPlane plane(observations.front().line.camera);
  const std::size_t count = std::min(observations.size(), kMaxLines);
  const double middle_s = 0.5 * (observations.front().line.time_s + observations.back().line.time_s);
  std::vector<Line> lines;
  for (std::size_t k = 0; k < count; ++k) {
    const LineOfSight& line = observations[k * (observations.size() - 1) / (count - 1)].line;
    lines.push_back({.time_s = line.time_s - middle_s,
                     .camera = plane.EnuFromGeodetic(line.camera),
                     .azimuth_rad = line.azimuth_rad,
                     .elevation_rad = line.elevation_rad,
                     .sigma_rad = std::max(line.sigma_rad.value_or(kMinSigma_rad), kMinSigma_rad)});
  }
  return lines;
}

// The largest angle between the azimuths of two lines, as seen from the first.
double TurnOf(std::span<const Line> lines) {
  double low = 0;
  double high = 0;
  for (const Line& line : lines) {
    const double turn = WrapAngle(line.azimuth_rad - lines.front().azimuth_rad);
    low = std::min(low, turn);
    high = std::max(high, turn);
  }
  return high - low;
}

struct Meeting {
  double cost = std::numeric_limits<double>::infinity();
  double median_sigmas = 0;  // median residual, in standard deviations
};

// The place nearest to the lines turned back by an angle, by iteratively reweighted least squares.
// @tparam kUnknowns  3: a point; 5: a point that moves steadily and level. A free rise would explain a wrong azimuth.
template <int kUnknowns>
Meeting Meet(std::span<const Line> lines, double error_rad) {
  static_assert(kUnknowns == 3 || kUnknowns == 5);
  using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  using Factors = Eigen::Matrix<double, 3, kUnknowns>;  // of the place at the time of a line
  const auto factors_of = [](const Line& line) {
    Factors factors = Factors::Identity();
    if constexpr (kUnknowns == 5)
      factors.template rightCols<2>() = line.time_s * Eigen::Matrix<double, 3, 2>::Identity();
    return factors;
  };
  Square prior = Square::Zero();
  if constexpr (kUnknowns == 5)
    prior.diagonal().template tail<2>().setConstant(1 / (kSigmaSpeed_m_s * kSigmaSpeed_m_s));
  constexpr double kMinRcond = kUnknowns == 5 ? 1e-13 : 1e-9;
  constexpr int kRounds = 4;
  constexpr double kHuber = 2;
  std::vector<double> sigmas(lines.size(), 0);  // residuals
  std::vector<double> distances_m(lines.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    Square normal = prior;
    Vector right = Vector::Zero();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Vector3d direction = lines[i].Direction(error_rad);
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
      const double weight = HuberWeight(sigmas[i], kHuber) / std::pow(distances_m[i] * lines[i].sigma_rad, 2);
      const Factors factors = factors_of(lines[i]);
      normal += weight * factors.transpose() * across * factors;
      right += weight * factors.transpose() * across * lines[i].camera;
    }
    const Eigen::LDLT<Square> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.rcond() > kMinRcond)) return {};
    const Vector unknowns = solver.solve(right);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Vector3d to_point = factors_of(lines[i]) * unknowns - lines[i].camera;
      const Vector3d direction = lines[i].Direction(error_rad);
      if (!(direction.dot(to_point) > 0)) return {};  // behind a camera
      distances_m[i] = to_point.norm();
      sigmas[i] = direction.cross(to_point).norm() / (distances_m[i] * lines[i].sigma_rad);
    }
  }
  Meeting meeting{.cost = 0};
  for (const double sigma : sigmas) meeting.cost += HuberLoss(sigma, kHuber);
  meeting.median_sigmas = Median(std::move(sigmas));
  return meeting;
}

// The angle at which the lines meet best, with its neighbours at one step.
struct BestAngle {
  double error_rad = 0;
  Meeting before;
  Meeting here;
  Meeting after;
};

constexpr double kStep_rad = RadiansFromDegrees(0.5);

// Coarse to fine: at steps of 4 degrees, then half of it around the best, down to kStep_rad.
BestAngle FindBestAngle(std::span<const Line> lines) {
  constexpr double kCoarse_rad = 8 * kStep_rad;
  constexpr int kSide = static_cast<int>(kMaxError_rad / kCoarse_rad);
  BestAngle best;
  for (int k = -kSide; k <= kSide; ++k) {
    const Meeting meeting = Meet<3>(lines, k * kCoarse_rad);
    if (meeting.cost >= best.here.cost) continue;
    best.here = meeting;
    best.error_rad = k * kCoarse_rad;
  }
  for (double step_rad = kCoarse_rad / 2; step_rad > 0.9 * kStep_rad; step_rad /= 2) {
    best.before = Meet<3>(lines, best.error_rad - step_rad);
    best.after = Meet<3>(lines, best.error_rad + step_rad);
    if (best.before.cost < best.here.cost && best.before.cost <= best.after.cost) {
      best = {.error_rad = best.error_rad - step_rad, .before = {}, .here = best.before, .after = best.here};
    } else if (best.after.cost < best.here.cost) {
      best = {.error_rad = best.error_rad + step_rad, .before = best.here, .here = best.after, .after = {}};
    }
  }
  // A step to the last side leaves the neighbour beyond it open.
  if (!std::isfinite(best.before.cost)) best.before = Meet<3>(lines, best.error_rad - kStep_rad);
  if (!std::isfinite(best.after.cost)) best.after = Meet<3>(lines, best.error_rad + kStep_rad);
  return best;
}

// The error that one object shows; std::nullopt if its lines determine none.
std::optional<double> ErrorOf(const ObservedTracklet& tracklet) {
  const std::vector<Line> lines = LinesOf(tracklet);
  if (lines.empty() || TurnOf(lines) < kMinTurn_rad) return std::nullopt;
  const BestAngle best = FindBestAngle(lines);
  const double before = best.before.cost;
  const double here = best.here.cost;
  const double after = best.after.cost;
  const double curvature = before - 2 * here + after;  // per kStep_rad^2
  if (!std::isfinite(curvature) || !(curvature > 0) || best.here.median_sigmas > kMaxMedianSigmas ||
      here > std::min(before, after)) {
    return std::nullopt;
  }
  // A cost of squares in standard deviations rises by 1 at one standard deviation.
  const double misfit = std::max(1.0, here / static_cast<double>(lines.size()));
  const double sigma_rad = kStep_rad * std::sqrt(2 * kCorrelated * misfit / curvature);
  if (sigma_rad > kMaxSigma_rad) return std::nullopt;
  // What drives steadily past a camera that flies straight looks as if the yaw were off.
  if (Meet<5>(lines, 0).cost <= here + kAmbiguous * kCorrelated * misfit) return std::nullopt;
  const double fraction = (before - after) / (2 * curvature);
  return best.error_rad + fraction * kStep_rad;
}

}  // namespace

std::optional<HeadingError> EstimateHeadingError(std::span<const ObservedTracklet> tracklets) {
  std::vector<std::optional<double>> errors_rad(tracklets.size());
  oneapi::tbb::parallel_for(std::size_t{0}, tracklets.size(),
                            [&](std::size_t i) { errors_rad[i] = ErrorOf(tracklets[i]); });
  std::vector<ErrorSample> samples;
  for (std::size_t i = 0; i < tracklets.size(); ++i) {
    if (errors_rad[i]) samples.push_back({&tracklets[i], *errors_rad[i]});
  }
  const auto agreed =
      FindAgreedError(samples, {.tolerance = kAgreement_rad, .min_error = kMinError_rad, .max_error = kMaxError_rad});
  if (!agreed) return std::nullopt;
  return HeadingError{.error_rad = agreed->error, .objects = agreed->objects};
}

void TurnBack(const HeadingError& error, std::span<ObservedTracklet> tracklets) {
  for (ObservedTracklet& tracklet : tracklets) {
    for (BearingObservation& observation : tracklet.observations) {
      const auto turn = [&](double& angle_rad) {
        angle_rad = WrapAngle(angle_rad - error.error_rad);
        if (angle_rad < 0) angle_rad += 2 * kPi;
      };
      turn(observation.line.azimuth_rad);
      if (observation.heading_rad) turn(*observation.heading_rad);
    }
  }
}

}  // namespace victorious
