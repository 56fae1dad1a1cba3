#include "victorious/place/calibrate/field_of_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/input/telemetry/focal_prior.h"
#include "victorious/place/calibrate/motion_comparison.h"
#include "victorious/place/calibrate/telemetry_noise.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Unknowns common to the flight; those of the seconds follow. Each is in units of its prior's standard deviation.
enum Common { kFocal, kSlopeEast, kSlopeNorth, kYaw, kPitch, kRoll, kNumCommon };
using Unknowns = Eigen::Matrix<double, kNumCommon, 1>;

// Of the logarithm of the focal length: so wide that it does not matter.
constexpr double kFocalPrior = 1;
// Roads are built with slopes up to 3 degrees; of the mean over all that is seen, one standard deviation.
constexpr double kSlopePrior = 0.035;
// Compasses are off by some degrees, gimbals by half a degree.
constexpr double kYawPrior_rad = RadiansFromDegrees(3);
constexpr double kGimbalPrior_rad = RadiansFromDegrees(0.5);
constexpr std::array<double, kNumCommon> kPriors = {kFocalPrior,   kSlopePrior,      kSlopePrior,
                                                    kYawPrior_rad, kGimbalPrior_rad, kGimbalPrior_rad};

constexpr std::size_t kMinPairsInSecond = 5;
constexpr std::size_t kMinSeconds = 4;
// What stands on the ground stays in view for some seconds: their residuals are correlated.
constexpr double kCorrelated = 3;

// Right, down, and the four derivatives, px per pair of frames at the sample points.
using Flow = Eigen::Matrix<double, 6, 1>;

struct Pair {
  PlanePose from;
  PlanePose to;
};

struct Second {
  std::vector<Pair> pairs;
  Vector3d start;  // camera at its first pair
  Flow seen = Flow::Zero();
};

// The camera with an error of attitude.
Eigen::Quaterniond Turned(const Eigen::Quaterniond& camera_from_plane, const Unknowns& unknowns) {
  const Eigen::AngleAxisd yaw(-unknowns[kYaw] * kYawPrior_rad, Vector3d::UnitZ());
  const Eigen::AngleAxisd pitch(unknowns[kPitch] * kGimbalPrior_rad, Vector3d::UnitX());
  const Eigen::AngleAxisd roll(unknowns[kRoll] * kGimbalPrior_rad, Vector3d::UnitZ());
  return roll * pitch * camera_from_plane * yaw;
}

class FlowModel {
 public:
  explicit FlowModel(const cv::Size& image) {
    // The second moment of nine points at this distance is that of corners all over the image.
    const Vector2d apart(image.width / std::sqrt(8.0), image.height / std::sqrt(8.0));
    for (const int x : {-1, 0, 1}) {
      for (const int y : {-1, 0, 1}) points_.push_back(apart.cwiseProduct(Vector2d(x, y)));
    }
    scale_px_ = apart.norm() * std::sqrt(2.0 / 3.0);
  }

  [[nodiscard]] Flow FromImage(const ImageFlow& flow) const {
    Flow values;
    values << flow.centre_px, scale_px_ * flow.gradient.row(0).transpose(),
        scale_px_ * flow.gradient.row(1).transpose();
    return values;
  }

  // The mean flow of a second; std::nullopt if the horizon is in view.
  // @param per_m  one over the camera's height above the ground at the start of the second
  [[nodiscard]] std::optional<Flow> Predict(const Second& second, const Unknowns& unknowns, double per_m) const {
    Flow sum = Flow::Zero();
    for (const Pair& pair : second.pairs) {
      const auto flow = PredictPair(pair, second.start, unknowns, per_m);
      if (!flow) return std::nullopt;
      sum += *flow;
    }
    return sum / static_cast<double>(second.pairs.size());
  }

 private:
  [[nodiscard]] std::optional<Flow> PredictPair(const Pair& pair, const Vector3d& start, const Unknowns& unknowns,
                                                double per_m) const {
    constexpr double kMinSine = 0.05;  // of the angle of a line of sight below the ground's horizon
    const double factor = std::exp(unknowns[kFocal] * kFocalPrior);
    const Eigen::Quaterniond from = Turned(pair.from.camera_from_plane, unknowns);
    const Eigen::Quaterniond to = Turned(pair.to.camera_from_plane, unknowns);
    const Vector3d normal(-unknowns[kSlopeEast] * kSlopePrior, -unknowns[kSlopeNorth] * kSlopePrior, 1);
    // Distance of the plane below the camera, times the length of `normal`, relative to that at the start.
    const double above = 1 + per_m * normal.dot(pair.from.place - start);
    if (!(above > 0)) return std::nullopt;
    std::vector<Vector2d> shifts;
    for (const Vector2d& point : points_) {
      const Vector3d ray = from.conjugate() * Vector3d((point / (factor * pair.from.focal_px)).homogeneous());
      const double down = -normal.dot(ray);
      if (down < kMinSine * ray.norm()) return std::nullopt;
      // A ground point at d along the ray, divided by d: (place + d ray - place') / d.
      const Vector3d there = to * (ray + per_m * down / above * (pair.from.place - pair.to.place));
      if (!(there.z() > 0)) return std::nullopt;
      shifts.push_back(factor * pair.to.focal_px * there.hnormalized() - point);
    }
    return FromShifts(shifts);
  }

  // The affine map of least squares; the points are symmetric.
  [[nodiscard]] Flow FromShifts(const std::vector<Vector2d>& shifts) const {
    ImageFlow flow;
    Vector2d squares = Vector2d::Zero();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      flow.centre_px += shifts[k] / static_cast<double>(points_.size());
      flow.gradient += shifts[k] * points_[k].transpose();
      squares += points_[k].cwiseAbs2();
    }
    flow.gradient *= squares.cwiseInverse().asDiagonal();
    return FromImage(flow);
  }

  std::vector<Vector2d> points_;  // relative to the middle of the image
  double scale_px_ = 0;
};

std::vector<Second> CollectSeconds(const ImageMotions& seen, const CameraTrajectory& cameras, const FlowModel& model) {
  const TangentPlane plane(cameras.states().front().place);
  std::map<std::int64_t, Second> of_second;
  for (const ImageMotion& motion : seen.motions) {
    if (!motion.flow) continue;
    const auto from = PoseAt(cameras, motion.from_s, plane, seen.image.width);
    const auto to = PoseAt(cameras, motion.to_s, plane, seen.image.width);
    if (!from || !to) continue;
    Second& second = of_second[static_cast<std::int64_t>(std::floor(motion.from_s))];
    if (second.pairs.empty()) second.start = from->place;
    second.pairs.push_back({*from, *to});
    second.seen += model.FromImage(*motion.flow);
  }
  std::vector<Second> seconds;
  for (auto& [number, second] : of_second) {
    if (second.pairs.size() < kMinPairsInSecond) continue;
    second.seen /= static_cast<double>(second.pairs.size());
    seconds.push_back(std::move(second));
  }
  return seconds;
}

class Fit {
 public:
  Fit(const FlowModel& model, const std::vector<Second>& seconds) : model_(model), seconds_(seconds) {}

  // The heights, and of these yaws the one, that fit best with the rest of telemetry as it is; false if none is
  // possible.
  bool Start(std::span<const double> yaws_rad) {
    double best = std::numeric_limits<double>::infinity();
    Unknowns best_unknowns = Unknowns::Zero();
    std::vector<double> best_per_m;
    for (const double yaw_rad : yaws_rad) {
      unknowns_.setZero();
      unknowns_[kYaw] = yaw_rad / kYawPrior_rad;
      const double misfit = FitHeights();
      if (misfit >= best) continue;
      best = misfit;
      best_unknowns = unknowns_;
      best_per_m = heights_per_m_;
    }
    unknowns_ = best_unknowns;
    heights_per_m_ = std::move(best_per_m);
    return std::isfinite(best);
  }

  // Gauss-Newton with robust scales of the six components; false if the unknowns leave what is possible, or explain the
  // motion no better than telemetry as it is: scales that grow and shrink with the residuals may lead away from a slew
  // that telemetry does not follow.
  bool Refine() {
    constexpr int kRounds = 30;
    const double misfit_before_px = Misfit();
    for (int round = 0; round < kRounds; ++round) {
      if (!Linearise()) return false;
      SetScales();
      MakeEquations();
      const Eigen::LDLT<CommonMatrix> solver(normal_);
      if (solver.info() != Eigen::Success) return false;
      const Unknowns step = solver.solve(right_);
      if (!step.allFinite()) return false;
      const double largest = std::max(std::abs(step[kFocal]) / kMaxFocalStep, 1.0);
      unknowns_ += step / largest;
      for (std::size_t i = 0; i < seconds_.size(); ++i) {
        heights_per_m_[i] *= std::exp(std::clamp(heights_[i].Step(step) / largest, -0.3, 0.3));
      }
    }
    const CommonMatrix covariance = Eigen::LDLT<CommonMatrix>(normal_).solve(CommonMatrix::Identity());
    variances_ = covariance.diagonal();
    return covariance.allFinite() && variances_.minCoeff() > 0 && Misfit() <= misfit_before_px;
  }

  [[nodiscard]] FocalMeasurement Focal() const {
    return {.log_factor = unknowns_[kFocal] * kFocalPrior, .sigma = std::sqrt(variances_[kFocal]) * kFocalPrior};
  }

  // The one with the largest part of what is known of the focal length.
  [[nodiscard]] std::size_t InformativeSecond() const {
    return static_cast<std::size_t>(std::ranges::max_element(focal_information_) - focal_information_.begin());
  }

  // Without its prior; std::nullopt if that is nearly all that is known.
  [[nodiscard]] std::optional<YawMeasurement> Yaw() const {
    constexpr double kMaxOfPrior = 0.5;
    const double of_prior = variances_[kYaw];
    if (of_prior > kMaxOfPrior) return std::nullopt;
    return YawMeasurement{.error_rad = unknowns_[kYaw] / (1 - of_prior) * kYawPrior_rad,
                          .sigma_rad = std::sqrt(of_prior / (1 - of_prior)) * kYawPrior_rad};
  }

 private:
  // The sum of the residuals; infinite if no height is possible.
  double FitHeights() {
    constexpr std::array kHeights_m = {10.0,  15.0,  22.0,  33.0,  50.0,   75.0,   110.0, 160.0,
                                       240.0, 360.0, 540.0, 800.0, 1600.0, 3200.0, 6400.0};
    double sum = 0;
    heights_per_m_.clear();
    for (const Second& second : seconds_) {
      double best = std::numeric_limits<double>::infinity();
      double best_per_m = 0;
      for (const double height_m : kHeights_m) {
        const auto flow = model_.Predict(second, unknowns_, 1 / height_m);
        if (!flow || (*flow - second.seen).norm() >= best) continue;
        best = (*flow - second.seen).norm();
        best_per_m = 1 / height_m;
      }
      sum += best;
      heights_per_m_.push_back(best_per_m);
    }
    return sum;
  }

  // The sum of the residuals; infinite where no flow is possible.
  [[nodiscard]] double Misfit() const {
    double sum = 0;
    for (std::size_t i = 0; i < seconds_.size(); ++i) {
      const auto flow = model_.Predict(seconds_[i], unknowns_, heights_per_m_[i]);
      if (!flow) return std::numeric_limits<double>::infinity();
      sum += (*flow - seconds_[i].seen).norm();
    }
    return sum;
  }

  static constexpr double kMaxFocalStep = 0.1;
  using CommonMatrix = Eigen::Matrix<double, kNumCommon, kNumCommon>;

  // The row of normal equations of one second's height, whose only other unknowns are the common ones.
  struct HeightEquation {
    double own = 1e-9;  // more than 0 keeps a height that nothing determines
    Unknowns common = Unknowns::Zero();
    double right = 0;

    // The step of the height for a step of the common unknowns.
    [[nodiscard]] double Step(const Unknowns& step) const { return (right - common.dot(step)) / own; }
  };

  // Residuals, and their derivatives by the common unknowns and by the logarithm of the second's own height.
  bool Linearise() {
    constexpr double kStep = 1e-3;
    residuals_.clear();
    derivatives_.clear();
    for (std::size_t i = 0; i < seconds_.size(); ++i) {
      const auto here = model_.Predict(seconds_[i], unknowns_, heights_per_m_[i]);
      if (!here) return false;
      Eigen::Matrix<double, 6, kNumCommon + 1> derivatives;
      for (int k = 0; k <= kNumCommon; ++k) {
        Unknowns moved = unknowns_;
        if (k < kNumCommon) moved[k] += kStep;
        const double per_m = heights_per_m_[i] * (k == kNumCommon ? std::exp(kStep) : 1);
        const auto there = model_.Predict(seconds_[i], moved, per_m);
        if (!there) return false;
        derivatives.col(k) = (*there - *here) / kStep;
      }
      residuals_.push_back(seconds_[i].seen - *here);
      derivatives_.push_back(derivatives);
    }
    return true;
  }

  void SetScales() {
    constexpr double kMin_px = 0.02;
    for (int c = 0; c < scales_px_.size(); ++c) {
      std::vector<double> sizes;
      for (const Flow& residual : residuals_) sizes.push_back(std::abs(residual[c]));
      scales_px_[c] = std::max(kMin_px, kMadToSigma * Median(std::move(sizes)));
    }
  }

  // The heights are eliminated (the Schur complement of a diagonal block): a residual depends on one of them only.
  void MakeEquations() {
    constexpr double kHuber = 2;
    normal_.setIdentity();
    right_ = -unknowns_;
    heights_.assign(seconds_.size(), {});
    focal_information_.assign(seconds_.size(), 0);
    for (std::size_t i = 0; i < seconds_.size(); ++i) {
      HeightEquation& height = heights_[i];
      for (int c = 0; c < scales_px_.size(); ++c) {
        const Unknowns row = derivatives_[i].row(c).head<kNumCommon>();
        const double own = derivatives_[i](c, kNumCommon);
        const double huber = HuberWeight(residuals_[i][c] / scales_px_[c], kHuber);
        const double weight = huber / (kCorrelated * scales_px_[c] * scales_px_[c]);
        normal_ += weight * row * row.transpose();
        right_ += weight * residuals_[i][c] * row;
        height.own += weight * own * own;
        height.common += weight * own * row;
        height.right += weight * own * residuals_[i][c];
        focal_information_[i] += weight * row[kFocal] * row[kFocal];
      }
      normal_ -= height.common * height.common.transpose() / height.own;
      right_ -= height.common * (height.right / height.own);
      focal_information_[i] -= height.common[kFocal] * height.common[kFocal] / height.own;
    }
  }

  const FlowModel& model_;
  const std::vector<Second>& seconds_;
  Unknowns unknowns_ = Unknowns::Zero();
  std::vector<double> heights_per_m_;
  std::vector<Flow> residuals_;
  std::vector<Eigen::Matrix<double, 6, kNumCommon + 1>> derivatives_;
  Flow scales_px_ = Flow::Ones();
  CommonMatrix normal_;
  Unknowns right_;
  std::vector<HeightEquation> heights_;    // one a second
  std::vector<double> focal_information_;  // one a second
  Unknowns variances_ = Unknowns::Zero();
};

// True if noise is a large part of what telemetry says of the motion in a second. The fit takes that for exact: noise
// would make the motion that telemetry predicts larger than the one that is seen, as a wrong focal length does.
bool IsTooNoisy(const CameraTrajectory& cameras, const std::vector<Second>& seconds) {
  constexpr double kMaxAttitudeNoise_rad = RadiansFromDegrees(0.15);
  constexpr double kMaxPlaceFraction = 0.1;  // of the way in a second
  const TelemetryNoise noise = EstimateNoise(cameras);
  std::vector<double> ways_m;
  for (const Second& second : seconds) ways_m.push_back((second.pairs.back().to.place - second.start).norm());
  return noise.attitude_rad > kMaxAttitudeNoise_rad ||
         std::numbers::sqrt2 * noise.place_m > kMaxPlaceFraction * Median(std::move(ways_m));
}

// True if the course is that of a straight flight.
bool IsStraight(const std::vector<Second>& seconds) {
  constexpr double kMinSpeed_m_s = 2;
  constexpr double kMaxTurn_rad = RadiansFromDegrees(3);  // from second to second
  std::vector<double> ways_m;
  std::vector<double> turns_rad;
  std::optional<double> last_rad;
  for (const Second& second : seconds) {
    const Vector3d way = second.pairs.back().to.place - second.pairs.front().from.place;
    const double course_rad = std::atan2(way.x(), way.y());
    ways_m.push_back(way.head<2>().norm());
    if (last_rad) turns_rad.push_back(std::abs(WrapAngle(course_rad - *last_rad)));
    last_rad = course_rad;
  }
  return Median(std::move(ways_m)) > kMinSpeed_m_s && Median(std::move(turns_rad)) < kMaxTurn_rad;
}

double NormalDensity(double value, double variance) {
  return std::exp(-value * value / (2 * variance)) / std::sqrt(variance);
}

// The chance that a normal variable is farther from 0 than `distance`.
double ChanceBeyond(double distance, double mean, double sigma) {
  const double per_sigma = 1 / (std::numbers::sqrt2 * sigma);
  return (std::erfc((distance - mean) * per_sigma) + std::erfc((distance + mean) * per_sigma)) / 2;
}

}  // namespace

std::optional<CameraErrors> MeasureCameraErrors(const ImageMotions& seen, const CameraTrajectory& cameras) {
  if (cameras.states().empty()) return std::nullopt;
  const FlowModel model(seen.image);
  const std::vector<Second> seconds = CollectSeconds(seen, cameras, model);
  if (seconds.size() < kMinSeconds || IsTooNoisy(cameras, seconds)) return std::nullopt;
  const bool is_straight = IsStraight(seconds);
  // Robust scales contain what all seconds share: far from its yaw the fit would stop.
  constexpr std::array kYaws_rad = {0.0,
                                    RadiansFromDegrees(-6),
                                    RadiansFromDegrees(6),
                                    RadiansFromDegrees(-12),
                                    RadiansFromDegrees(12),
                                    RadiansFromDegrees(-18),
                                    RadiansFromDegrees(18)};
  const std::span yaws_rad = std::span(kYaws_rad).first(is_straight ? kYaws_rad.size() : 1);
  Fit fit(model, seconds);
  if (!fit.Start(yaws_rad) || !fit.Refine()) return std::nullopt;
  CameraErrors errors{.focal = fit.Focal(), .yaw = is_straight ? fit.Yaw() : std::nullopt};
  // A fast slew that telemetry follows late, or the tracker not at all, outweighs minutes of steady flight.
  std::vector<Second> others = seconds;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(fit.InformativeSecond()));
  Fit rest(model, others);
  const bool is_known = rest.Start(yaws_rad) && rest.Refine();
  const double change = is_known ? errors.focal.log_factor - rest.Focal().log_factor : kFocalPrior;
  errors.focal.sigma = std::hypot(errors.focal.sigma, change);
  return errors;
}

std::optional<double> SignificantYawError(const YawMeasurement& measured) {
  constexpr double kMinError_rad = RadiansFromDegrees(1.5);  // three times the usual one
  constexpr double kMinSigmas = 3;
  const double size_rad = std::abs(measured.error_rad);
  return size_rad > kMinError_rad && size_rad > kMinSigmas * measured.sigma_rad ? std::optional(measured.error_rad)
                                                                                : std::nullopt;
}

FieldOfViewVerdict JudgeFieldOfView(const std::optional<FocalMeasurement>& measured) {
  constexpr double kWrong = kWrongFocalProbability;
  constexpr double kRightVariance = kRightFocalSigma * kRightFocalSigma;
  constexpr double kWrongVariance = kWrongFocalSigma * kWrongFocalSigma;
  if (!measured) {
    return {.wrong_probability = kWrong,
            .log_factor = 0,
            .sigma = std::sqrt((1 - kWrong) * kRightVariance + kWrong * kWrongVariance)};
  }
  const double variance = measured->sigma * measured->sigma;
  const double if_right = (1 - kWrong) * NormalDensity(measured->log_factor, variance + kRightVariance);
  const double if_wrong = kWrong * NormalDensity(measured->log_factor, variance + kWrongVariance);
  const double wrong = if_wrong > 0 ? if_wrong / (if_wrong + if_right) : 1;
  // Mean and variance after the measurement, in each case.
  const auto mean = [&](double prior) { return measured->log_factor * prior / (prior + variance); };
  const auto rest = [&](double prior) { return variance * prior / (prior + variance); };
  FieldOfViewVerdict verdict{
      .wrong_probability = wrong, .log_factor = wrong > 0.5 ? mean(kWrongVariance) : 0, .sigma = 0};
  const auto square_about = [&](double prior) { return std::pow(mean(prior) - verdict.log_factor, 2) + rest(prior); };
  const double sigma = std::sqrt((1 - wrong) * square_about(kRightVariance) + wrong * square_about(kWrongVariance));
  // Two distant possibilities are wider than a normal distribution of their standard deviation: 90 % lie within
  // kSigmasOf90 * verdict.sigma.
  const auto chance_beyond = [&](double distance) {
    const auto beyond = [&](double prior) {
      return ChanceBeyond(distance, mean(prior) - verdict.log_factor, std::sqrt(rest(prior)));
    };
    return (1 - wrong) * beyond(kRightVariance) + wrong * beyond(kWrongVariance);
  };
  constexpr double kSigmasOf90 = 1.6449;
  double low = sigma;
  double high = 10 * sigma;  // Chebyshev: 1 % at most lie beyond
  while (chance_beyond(kSigmasOf90 * low) > 0.1 && high - low > 1e-4 * sigma) {
    const double middle = (low + high) / 2;
    (chance_beyond(kSigmasOf90 * middle) > 0.1 ? low : high) = middle;
  }
  verdict.sigma = low;
  return verdict;
}

}  // namespace victorious
