#include "victorious/place/geolocate/path_smoother.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "victorious/base/median.h"
#include "victorious/base/robust_statistics.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Row = Eigen::Matrix<double, 1, kPathUnknowns>;

constexpr int kVelocity = 3;
constexpr int kMotion = 6;  // place and velocity
constexpr int kConstants = kPathUnknowns - kMotion;
constexpr int kCommon = kMotion;
using MotionRows = Eigen::Matrix<double, kMotion, kPathUnknowns>;
constexpr int kRangeError = kCommon + 6;
constexpr int kGround = kCommon + kNumCommonErrors;

// Spectral densities of the horizontal acceleration, m^2/s^3: of straight driving (0.3 m/s in ten seconds), at the
// start of the iteration, and of the hardest turn (a change by 10 m/s within a second, at ten rays a second).
constexpr double kMinDensity = 0.01;
constexpr double kFirstDensity = 1;
constexpr double kMaxDensity = 30;
constexpr double kPriorCount = 2;       // number of changes of velocity that the prior, kMinDensity, counts as
constexpr double kHalfWindow_s = 0.25;  // a manoeuvre lasts at least twice this
constexpr double kGroundNoise_m = 1;    // unevenness under a moving object
// Ranges that scatter more are not explained: a path through the cameras would fit any lines.
constexpr double kMaxRangeFactor = 3;

struct Measurement {
  Row row;
  double value = 0;
  double sigma = 1;
};

struct RayRows {
  std::array<Measurement, 3> of_ray;  // side, rise, range
  std::optional<Measurement> of_ground;
};

// The rows of one ray. Offsets are measured perpendicular to the direction to the object, not to the ray: a shorter
// distance would reduce the latter, and the path would shrink towards the camera.
// @param to_object  from the camera, by the round before
RayRows MakeRows(const Ray& ray, const Vector3d& to_object, const std::optional<GroundPatch>& patch,
                 double ground_sigma_m, const LocateOptions& options) {
  const double distance_m = std::max(1.0, to_object.norm());
  const Vector3d direction = MaxLikelihoodDirection(ray, ray.forward, to_object, options.line.position_m);
  const Vector3d side = (ray.side - direction * direction.dot(ray.side)).normalized();
  const Vector3d rise = side.cross(direction);
  const Eigen::Matrix<double, kNumCommonErrors, 1> sigmas = CommonErrorSigmas(options.common);
  const auto along = [&](const Vector3d& axis) {
    Measurement one;
    one.row.setZero();
    one.row.head<3>() = axis.transpose();
    one.row.segment<3>(kCommon) = -axis.cwiseProduct(sigmas.head<3>()).transpose();
    one.value = axis.dot(ray.camera + distance_m * ray.forward);
    return one;
  };
  RayRows result{.of_ray = {along(side), along(rise), along(direction)}, .of_ground = {}};
  std::array<Measurement, 3>& rows = result.of_ray;
  rows[0].row[kCommon + 3] = -distance_m * ray.cos_elevation * sigmas[3];
  rows[0].row[kCommon + 4] = -distance_m * sigmas[4];
  rows[1].row[kCommon + 5] = -distance_m * sigmas[5];
  rows[2].row[kRangeError] = -distance_m * sigmas[6];
  rows[2].value = direction.dot(ray.camera) + ray.range_m;
  rows[0].sigma = rows[1].sigma = std::hypot(distance_m * ray.sigma_rad, options.line.position_m);
  const double range_sigma_m = ray.range_fraction > 0 ? ray.range_fraction * distance_m : ray.sigma_range_m;
  rows[2].sigma = std::hypot(range_sigma_m, options.line.position_m);
  if (patch) {
    Measurement& on_ground = result.of_ground.emplace();
    on_ground.row.setZero();
    on_ground.row.head<3>() = patch->normal.transpose();
    on_ground.row[kGround] = -ground_sigma_m * patch->normal.z();
    on_ground.value = patch->normal.dot(patch->point);
    on_ground.sigma = kGroundNoise_m;
  }
  return result;
}

// Kalman update by one row.
void Update(const Measurement& measured, double sigma, PathVector& mean, PathMatrix& covariance) {
  const PathVector gained = covariance * measured.row.transpose();
  const double variance = measured.row * gained + sigma * sigma;
  mean += gained / variance * (measured.value - measured.row.dot(mean));
  covariance.noalias() -= gained * (gained.transpose() / variance);
}

// The prediction over an interval.
struct Step {
  double duration_s = 0;
  double density = 0;
  double vertical_density = 0;

  [[nodiscard]] PathVector Predict(PathVector mean) const {
    mean.head<3>() += duration_s * mean.segment<3>(kVelocity);
    return mean;
  }
  [[nodiscard]] PathMatrix Predict(PathMatrix covariance) const {
    covariance.topRows<3>() += duration_s * covariance.middleRows<3>(kVelocity);
    covariance.leftCols<3>() += duration_s * covariance.middleCols<3>(kVelocity);
    for (int axis = 0; axis < 3; ++axis) {
      const double q = axis < 2 ? density : vertical_density;
      const double dt = duration_s;
      covariance(axis, axis) += q * dt * dt * dt / 3;
      covariance(axis, kVelocity + axis) += q * dt * dt / 2;
      covariance(kVelocity + axis, axis) += q * dt * dt / 2;
      covariance(kVelocity + axis, kVelocity + axis) += q * dt;
    }
    return covariance;
  }
  // The derivative of place and velocity by the next state, among all states that the filtered ones allow. What is
  // constant is that of the next state.
  [[nodiscard]] MotionRows Gain(const PathMatrix& covariance, const PathMatrix& predicted) const {
    if (density == 0 && vertical_density == 0) {  // the next state determines this one
      MotionRows gain = MotionRows::Identity();
      gain.block<3, 3>(0, kVelocity).diagonal().setConstant(-duration_s);
      return gain;
    }
    MotionRows cross = covariance.topRows<kMotion>();  // covariance with the prediction
    cross.leftCols<3>() += duration_s * covariance.block<kMotion, 3>(0, kVelocity);
    return predicted.ldlt().solve(cross.transpose()).transpose();
  }
};

// A smoothed change of the velocity over an interval.
struct VelocityChange {
  double squared = 0;            // horizontal: |dv|^2 / dt, m^2/s^3
  double unknowns = 0;           // horizontal: effective number of unknowns, 0 to 2
  double vertical_unknowns = 0;  // 0 to 1
};

class Smoother {
 public:
  Smoother(std::span<const Ray> rays, const TangentPlane& plane, const PathModel& model, const LocateOptions& options)
      : rays_(rays),
        plane_(plane),
        model_(model),
        options_(options),
        densities_(rays.size(), model.manoeuvres ? kFirstDensity : 0),
        weights_(rays.size(), {1, 1, 1}),
        changes_(rays.size()) {
    fit_.means.resize(rays.size());
    fit_.covariances.resize(rays.size());
    fit_.residuals.resize(rays.size());
  }

  PathFit Run() && {
    const int rounds = model_.manoeuvres ? 10 : 5;
    for (int round = 0; round < rounds; ++round) {
      Filter();
      Smooth();
      Compare();
      if (round + 1 < rounds && model_.manoeuvres) EstimateDensities();
    }
    if (model_.manoeuvres && !IsRangeErrorObserved()) FixRangeError();
    for (const VelocityChange& change : changes_) fit_.manoeuvre_unknowns += change.unknowns + change.vertical_unknowns;
    return std::move(fit_);
  }

 private:
  // The common error of the ranges scales the path. Where nothing else than the ranges fixes the scale (camera and
  // object move straight), the shortest changes of velocity would: it stays 0, with its covariance.
  [[nodiscard]] bool IsRangeErrorObserved() const {
    constexpr double kObservedVariance = 0.5;  // of 1 beforehand
    return fit_.covariances.front()(kRangeError, kRangeError) < kObservedVariance;
  }

  void FixRangeError() {
    range_error_is_free_ = false;
    const std::vector<PathMatrix> covariances = fit_.covariances;
    const std::vector<VelocityChange> changes = changes_;
    Filter();
    Smooth();
    Compare();
    fit_.covariances = covariances;
    changes_ = changes;
  }

  [[nodiscard]] Step StepAfter(std::size_t i) const {
    return {.duration_s = rays_[i + 1].time_s - rays_[i].time_s,
            .density = densities_[i],
            .vertical_density = model_.vertical_density};
  }

  [[nodiscard]] std::optional<GroundPatch> PatchUnder(std::size_t i) const {
    if (model_.ground == nullptr) return std::nullopt;
    return GroundPatchAt(*model_.ground, plane_, PlaceOf(i));
  }

  // By the round before; in the first, by the range.
  [[nodiscard]] Vector3d PlaceOf(std::size_t i) const { return places_.empty() ? EndOf(rays_[i]) : places_[i]; }

  static Vector3d EndOf(const Ray& ray) { return ray.camera + ray.range_m * ray.forward; }

  void Filter() {
    PathVector mean = PathVector::Zero();
    mean.head<3>() = EndOf(rays_.front());
    PathVector sigmas = PathVector::Ones();
    sigmas.head<3>().setConstant(std::max(1.0, rays_.front().range_m));
    sigmas.segment<3>(kVelocity) << model_.speed_sigma_m_s, model_.speed_sigma_m_s, model_.climb_sigma_m_s;
    PathMatrix covariance = sigmas.cwiseAbs2().asDiagonal();
    rows_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (i > 0) {
        const Step step = StepAfter(i - 1);
        mean = step.Predict(mean);
        covariance = step.Predict(covariance);
      }
      rows_.push_back(MakeRows(rays_[i], PlaceOf(i) - rays_[i].camera, PatchUnder(i), model_.ground_sigma_m, options_));
      if (!range_error_is_free_) rows_[i].of_ray[2].row[kRangeError] = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Measurement& row = rows_[i].of_ray[k];
        const double factor = k < 2 ? fit_.angle_factor : fit_.range_factor;
        Update(row, row.sigma * factor / std::sqrt(weights_[i][k]), mean, covariance);
      }
      if (rows_[i].of_ground) Update(*rows_[i].of_ground, rows_[i].of_ground->sigma, mean, covariance);
      covariance = (covariance + covariance.transpose()).eval() / 2;
      fit_.means[i] = mean;
      fit_.covariances[i] = covariance;
    }
  }

  void Smooth() {
    for (std::size_t i = rays_.size() - 1; i-- > 0;) {
      const Step step = StepAfter(i);
      PathVector& mean = fit_.means[i];
      PathMatrix& covariance = fit_.covariances[i];
      const PathMatrix predicted = step.Predict(covariance);
      const MotionRows gain = step.Gain(covariance, predicted);
      const PathMatrix& after = fit_.covariances[i + 1];
      const PathMatrix learnt = after - predicted;
      const MotionRows gained = gain.lazyProduct(learnt);
      mean.head<kMotion>() += gain * (fit_.means[i + 1] - step.Predict(mean));
      mean.tail<kConstants>() = fit_.means[i + 1].tail<kConstants>();
      auto of_motion = covariance.topLeftCorner<kMotion, kMotion>();
      of_motion += gained.lazyProduct(gain.transpose());
      of_motion = (of_motion + of_motion.transpose()).eval() / 2;
      auto shared = covariance.topRightCorner<kMotion, kConstants>();
      shared += gained.rightCols<kConstants>();
      covariance.bottomLeftCorner<kConstants, kMotion>() = shared.transpose();
      covariance.bottomRightCorner<kConstants, kConstants>() = after.bottomRightCorner<kConstants, kConstants>();
      changes_[i] = ChangeAfter(i, step, gain);
    }
  }

  [[nodiscard]] VelocityChange ChangeAfter(std::size_t i, const Step& step, const MotionRows& gain) const {
    VelocityChange change;
    const auto unknowns = [&](int axis, double density) {
      const double prior = density * step.duration_s;
      const PathMatrix& after = fit_.covariances[i + 1];
      const double lagged = gain.row(axis).dot(after.row(axis));  // covariance with the next one
      const double posterior = fit_.covariances[i](axis, axis) + after(axis, axis) - 2 * lagged;
      return prior > 0 ? std::clamp(1 - posterior / prior, 0.0, 1.0) : 0.0;
    };
    for (int axis = kVelocity; axis < kVelocity + 2 && step.duration_s > 0; ++axis) {
      change.unknowns += unknowns(axis, step.density);
      change.squared += std::pow(fit_.means[i + 1][axis] - fit_.means[i][axis], 2) / step.duration_s;
    }
    change.vertical_unknowns = unknowns(kVelocity + 2, step.vertical_density);
    return change;
  }

  // Residuals, noise factors, weights and distances from the smoothed path.
  void Compare() {
    std::vector<double> across;
    std::vector<double> along;
    places_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const auto residual = [&](std::size_t k) {
        const Measurement& measured = rows_[i].of_ray[k];
        return (measured.value - measured.row.dot(fit_.means[i])) / measured.sigma;
      };
      fit_.residuals[i] = {residual(0), residual(1), residual(2)};
      across.push_back(std::hypot(fit_.residuals[i].side, fit_.residuals[i].rise));
      along.push_back(std::abs(fit_.residuals[i].range));
      places_.emplace_back(fit_.means[i].head<3>());
    }
    fit_.angle_factor = std::max(1.0, Median(across) / kRayleighMedian);
    fit_.range_factor = std::clamp(Median(along) * kMadToSigma, 1.0, kMaxRangeFactor);
    ++rounds_;
    // Huber's weight; once the path has settled, lines beyond the gate have none. Ranges always count.
    constexpr int kRoundsToSettle = 3;
    constexpr double kNone = 1e-6;
    const auto weight = [&](double residual, double factor) {
      return HuberWeight(residual, options_.robust_sigma * factor);
    };
    const auto is_outlier = [&](double residual) {
      return rounds_ > kRoundsToSettle && residual > options_.gate_sigma * fit_.angle_factor;
    };
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const double of_line = is_outlier(across[i]) ? kNone : weight(across[i], fit_.angle_factor);
      weights_[i] = {of_line, of_line, weight(along[i], fit_.range_factor)};
    }
  }

  void EstimateDensities() {
    const std::size_t intervals = rays_.size() - 1;
    const auto middle_s = [&](std::size_t i) { return (rays_[i].time_s + rays_[i + 1].time_s) / 2; };
    std::size_t begin = 0;
    std::size_t end = 0;
    VelocityChange sum;
    for (std::size_t i = 0; i < intervals; ++i) {
      for (; end < intervals && middle_s(end) <= middle_s(i) + kHalfWindow_s; ++end) {
        sum.squared += changes_[end].squared;
        sum.unknowns += changes_[end].unknowns;
      }
      for (; middle_s(begin) < middle_s(i) - kHalfWindow_s; ++begin) {
        sum.squared -= changes_[begin].squared;
        sum.unknowns -= changes_[begin].unknowns;
      }
      densities_[i] = std::clamp((kPriorCount * kMinDensity + sum.squared) / (kPriorCount + sum.unknowns), kMinDensity,
                                 kMaxDensity);
    }
  }

  std::span<const Ray> rays_;
  const TangentPlane& plane_;
  const PathModel& model_;
  const LocateOptions& options_;
  std::vector<double> densities_;               // of the interval after each ray
  std::vector<std::array<double, 3>> weights_;  // of side, rise, range
  std::vector<VelocityChange> changes_;         // over the interval after each ray
  std::vector<Vector3d> places_;                // smoothed, of the round before; empty in the first
  std::vector<RayRows> rows_;
  bool range_error_is_free_ = true;
  int rounds_ = 0;
  PathFit fit_;
};

}  // namespace

PathModel StaticPath() {
  constexpr double kAtRest_m_s = 1e-4;
  return {.speed_sigma_m_s = kAtRest_m_s, .climb_sigma_m_s = kAtRest_m_s};
}

PathFit FitPath(std::span<const Ray> rays, const TangentPlane& plane, const PathModel& model,
                const LocateOptions& options) {
  return Smoother(rays, plane, model, options).Run();
}

}  // namespace victorious
