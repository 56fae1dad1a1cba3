#include "victorious/place/geolocate/refine_place.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <Eigen/Eigenvalues>
#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "victorious/base/median.h"
#include "victorious/geometry/unit_diagonal.h"
#include "victorious/place/geolocate/linear_place.h"

namespace victorious {
namespace {

using CommonVector = Eigen::Matrix<double, kNumCommonErrors, 1>;

struct Estimate {
  Eigen::Vector3d place;
  Eigen::Vector3d velocity;
  CommonVector common = CommonVector::Zero();  // in sigmas

  [[nodiscard]] Motion motion() const { return {place, velocity}; }
};

// The linearisation of a ray in one round: quantities that depend on the place, kept constant because they would bias
// the estimate if they varied with it.
struct RayFrame {
  double distance_m = 0;
  double sigma_m = 0;     // of the ray's own error at that distance, across the ray
  Eigen::Vector3d along;  // maximum-likelihood direction
  Eigen::Vector3d side;   // perpendicular to `along`
  Eigen::Vector3d rise;
};

// Vector from the camera, corrected by its common error, to the object.
template <typename T>
Eigen::Matrix<T, 3, 1> CameraToObject(const Ray& ray, const CommonVector& sigmas, const T* place, const T* velocity,
                                      const T* common) {
  Eigen::Matrix<T, 3, 1> to_object;
  for (int k = 0; k < 3; ++k)
    to_object[k] = place[k] + velocity[k] * ray.time_s - ray.camera[k] - common[k] * sigmas[k];
  return to_object;
}

// Residual: the object's offset from the ray, to the side and upwards, in units of the ray's own error there.
struct OffsetError {
  const Ray& ray;
  const CommonVector& sigmas;
  RayFrame ray_frame;

  template <typename T>
  bool operator()(const T* place, const T* velocity, const T* common, T* residuals) const {
    const Eigen::Matrix<T, 3, 1> to_object = CameraToObject(ray, sigmas, place, velocity, common);
    const Eigen::Matrix<T, 3, 1> off = to_object - (ray_frame.distance_m * ray.forward).template cast<T>();
    const T to_side = common[3] * sigmas[3] * ray.cos_elevation + common[4] * sigmas[4];
    const T to_rise = common[5] * sigmas[5];
    residuals[0] = (off.dot(ray_frame.side.template cast<T>()) - ray_frame.distance_m * to_side) / ray_frame.sigma_m;
    residuals[1] = (off.dot(ray_frame.rise.template cast<T>()) - ray_frame.distance_m * to_rise) / ray_frame.sigma_m;
    return true;
  }
};

struct RangeError {
  const Ray& ray;
  const CommonVector& sigmas;
  double sigma_m;

  template <typename T>
  bool operator()(const T* place, const T* velocity, const T* common, T* residual) const {
    const T given = ray.range_m * (1.0 + common[6] * sigmas[6]);
    residual[0] = (CameraToObject(ray, sigmas, place, velocity, common).norm() - given) / sigma_m;
    return true;
  }
};

// Residual: distance from the ground patch vertically below the place at the start of the round.
struct GroundError {
  GroundPatch patch;
  double sigma_m;  // along the normal

  template <typename T>
  bool operator()(const T* place, T* residual) const {
    residual[0] = T(0);
    for (int k = 0; k < 3; ++k) residual[0] += patch.normal[k] * (place[k] - patch.point[k]) / sigma_m;
    return true;
  }
};

struct CommonPrior {
  template <typename T>
  bool operator()(const T* common, T* residuals) const {
    std::copy_n(common, kNumCommonErrors, residuals);
    return true;
  }
};

// The normal matrix J'J of the free unknowns.
Eigen::MatrixXd NormalMatrix(ceres::Problem& problem, std::vector<double*> free) {
  ceres::Problem::EvaluateOptions evaluate;
  evaluate.parameter_blocks = std::move(free);
  ceres::CRSMatrix jacobian;
  problem.Evaluate(evaluate, nullptr, nullptr, nullptr, &jacobian);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  for (std::size_t row = 0; row + 1 < jacobian.rows.size(); ++row) {
    for (int i = jacobian.rows[row]; i < jacobian.rows[row + 1]; ++i) {
      for (int k = jacobian.rows[row]; k < jacobian.rows[row + 1]; ++k) {
        const auto [at_i, at_k] = std::pair(static_cast<std::size_t>(i), static_cast<std::size_t>(k));
        normal(jacobian.cols[at_i], jacobian.cols[at_k]) += jacobian.values[at_i] * jacobian.values[at_k];
      }
    }
  }
  return normal;
}

// The inverse; std::nullopt if the matrix, scaled to unit diagonal, is singular.
std::optional<Eigen::MatrixXd> Inverse(const Eigen::MatrixXd& normal) {
  const auto scaled = ScaleToUnitDiagonal(normal);
  if (!scaled) return std::nullopt;
  const Eigen::VectorXd& scale = scaled->scale;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled->matrix);
  constexpr double kMinEigenvalue = 1e-13;
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues().minCoeff() > kMinEigenvalue)) return std::nullopt;
  const Eigen::MatrixXd inverse =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  return Eigen::MatrixXd(scale.asDiagonal() * inverse * scale.asDiagonal());
}

// The covariance of the estimated unknowns, from the normal matrix of all unknowns. An unknown that is set to 0 but has
// an error of one sigma shifts the estimate by  inverse(N_ee) N_eh.
std::optional<Eigen::MatrixXd> Covariance(const Eigen::MatrixXd& normal, const std::vector<int>& fixed) {
  std::vector<int> estimated;
  for (int i = 0; i < normal.rows(); ++i) {
    if (std::ranges::find(fixed, i) == fixed.end()) estimated.push_back(i);
  }
  auto covariance = Inverse(normal(estimated, estimated));
  if (!covariance) return covariance;
  const Eigen::MatrixXd moved = *covariance * normal(estimated, fixed);
  return Eigen::MatrixXd(*covariance + moved * moved.transpose());
}

class Refinement {
 public:
  Refinement(std::span<const Ray> rays, const TangentPlane& plane, const LocateOptions& options)
      : rays_(rays), plane_(plane), options_(options), sigmas_(CommonErrorSigmas(options.common)) {}

  /// One minimisation with the linearisation at the start. Returns the covariance, or std::nullopt if it does not
  /// exist.
  std::optional<Eigen::MatrixXd> Minimise(const std::vector<bool>& inliers, double noise_factor, Estimate& estimate) {
    ceres::Problem::Options shared;
    shared.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(shared);
    ceres::HuberLoss huber(options_.robust_sigma);
    double* const place = estimate.place.data();
    double* const velocity = estimate.velocity.data();
    double* const common = estimate.common.data();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (!inliers[i]) continue;
      const Ray& ray = rays_[i];
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OffsetError, 2, 3, 3, kNumCommonErrors>(
                                   new OffsetError{ray, sigmas_, MakeRayFrame(ray, estimate, noise_factor)}),
                               &huber, place, velocity, common);
      if (ray.range_source != RangeSource::kMeasured) continue;
      const double sigma_m = std::hypot(RangeSigma(ray, estimate), options_.line.position_m);
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<RangeError, 1, 3, 3, kNumCommonErrors>(new RangeError{ray, sigmas_, sigma_m}),
          &huber, place, velocity, common);
    }
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CommonPrior, kNumCommonErrors, kNumCommonErrors>(new CommonPrior), nullptr,
        common);
    const auto patch = options_.ground ? GroundPatchAt(*options_.ground, plane_, estimate.place) : std::nullopt;
    if (patch) {
      const double sigma_m = options_.ground_sigma_m * VerticalPart(*patch, plane_);
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<GroundError, 1, 3>(new GroundError{*patch, sigma_m}),
                               nullptr, place);
    }
    // Errors in position, elevation and range factor have nearly the same effect on the lines as a shift of the place:
    // as free unknowns, they would absorb the lines' own errors. They stay 0 and inflate the covariance; a known ground
    // separates the first two.
    std::vector<int> fixed = {6};
    if (!patch) fixed = {0, 1, 2, 5, 6};
    problem.SetManifold(common, new ceres::SubsetManifold(kNumCommonErrors, fixed));
    std::vector<double*> free = {place, velocity, common};
    if (options_.motion == MotionModel::kStatic) {
      problem.SetParameterBlockConstant(velocity);
      free = {place, common};
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = 50;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable() || !estimate.place.allFinite()) return std::nullopt;
    problem.SetManifold(common, nullptr);
    const int first_common = options_.motion == MotionModel::kStatic ? 3 : 6;
    for (int& one : fixed) one += first_common;
    Eigen::MatrixXd normal = NormalMatrix(problem, free);
    normal.topLeftCorner(first_common, first_common) -= NoiseBias(inliers, noise_factor, estimate, first_common);
    return Covariance(normal, fixed);
  }

  /// The inliers: rays whose offset from the object, corrected for the common errors, is within the gate and the
  /// identity radius.
  [[nodiscard]] std::vector<bool> FindInliers(const Estimate& estimate, double noise_factor) const {
    std::vector<bool> inliers(rays_.size());
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const Ray& ray = rays_[i];
      const double along_m = ToObject(ray, estimate).dot(ray.forward);
      if (along_m < ray.frustum.nearest_m || along_m > ray.frustum.farthest_m) continue;
      const RayFrame ray_frame = MakeRayFrame(ray, estimate, noise_factor);
      const double gate = std::hypot(options_.gate_sigma, options_.identity_radius_m / ray_frame.sigma_m);
      inliers[i] = Residual(ray, ray_frame, estimate).norm() <= gate;
    }
    return inliers;
  }

  /// The ratio of the rays' own errors to their given sigmas, from the median residual, at least 1.
  [[nodiscard]] double NoiseFactor(const std::vector<bool>& inliers, const Estimate& estimate) const {
    std::vector<double> offsets;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (inliers[i]) offsets.push_back(Residual(rays_[i], MakeRayFrame(rays_[i], estimate, 1), estimate).norm());
    }
    constexpr std::size_t kMinResiduals = 10;  // minimum number of residuals for an estimate of their spread
    if (offsets.size() < kMinResiduals) return 1;
    return std::max(1.0, Median(std::move(offsets)) / kRayleighMedian);
  }

 private:
  // The spurious information about the place (and the velocity, with 6 unknowns) due to noise in the rays' directions.
  [[nodiscard]] Eigen::MatrixXd NoiseBias(const std::vector<bool>& inliers, double noise_factor,
                                          const Estimate& estimate, int unknowns) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(unknowns, unknowns);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      if (!inliers[i]) continue;
      const RayFrame ray_frame = MakeRayFrame(rays_[i], estimate, noise_factor);
      Eigen::VectorXd along(unknowns);
      along.head<3>() = ray_frame.along / ray_frame.sigma_m;
      if (unknowns == 6) along.tail<3>() = rays_[i].time_s * along.head<3>();
      sum += DirectionVariance(rays_[i], ray_frame.distance_m, options_.line.position_m) * along * along.transpose();
    }
    return noise_factor * noise_factor * NoiseBiasFactor(std::ranges::count(inliers, true)) * sum;
  }

  [[nodiscard]] Eigen::Vector3d ToObject(const Ray& ray, const Estimate& estimate) const {
    return CameraToObject<double>(ray, sigmas_, estimate.place.data(), estimate.velocity.data(),
                                  estimate.common.data());
  }

  // A relative sigma refers to the true range: relative to the measured range it would weight short ranges more and
  // bias the place towards the camera.
  [[nodiscard]] double RangeSigma(const Ray& ray, const Estimate& estimate) const {
    return ray.range_fraction > 0 ? ray.range_fraction * ToObject(ray, estimate).norm() : ray.sigma_range_m;
  }

  [[nodiscard]] RayFrame MakeRayFrame(const Ray& ray, const Estimate& estimate, double noise_factor) const {
    const Eigen::Vector3d to_object = ToObject(ray, estimate);
    RayFrame ray_frame;
    ray_frame.distance_m = std::max(1.0, to_object.norm());
    ray_frame.sigma_m = noise_factor * std::hypot(ray_frame.distance_m * ray.sigma_rad, options_.line.position_m);
    const CommonVector common = estimate.common.cwiseProduct(sigmas_);
    const Eigen::Vector3d given =
        ray.forward - (common[3] * ray.cos_elevation + common[4]) * ray.side - common[5] * ray.rise;
    ray_frame.along = MaxLikelihoodDirection(ray, given, to_object, options_.line.position_m);
    ray_frame.side = (ray.side - ray_frame.along * ray_frame.along.dot(ray.side)).normalized();
    ray_frame.rise = ray_frame.side.cross(ray_frame.along);
    return ray_frame;
  }

  [[nodiscard]] Eigen::Vector2d Residual(const Ray& ray, const RayFrame& ray_frame, const Estimate& estimate) const {
    Eigen::Vector2d offset;
    OffsetError{ray, sigmas_, ray_frame}(estimate.place.data(), estimate.velocity.data(), estimate.common.data(),
                                         offset.data());
    return offset;
  }

  std::span<const Ray> rays_;
  const TangentPlane& plane_;
  const LocateOptions& options_;
  CommonVector sigmas_;
};

}  // namespace

std::optional<RefinedPlace> RefinePlace(std::span<const Ray> rays, const Motion& start, std::vector<bool> inliers,
                                        const TangentPlane& plane, const LocateOptions& options) {
  Refinement refinement(rays, plane, options);
  Estimate estimate{start.place, start.velocity};
  double noise_factor = 1;
  std::optional<Eigen::MatrixXd> covariance;
  constexpr int kMaxRounds = 12;
  for (int round = 1;; ++round) {
    const Eigen::Vector3d before = estimate.place;
    covariance = refinement.Minimise(inliers, noise_factor, estimate);
    if (!covariance) return std::nullopt;
    const double given = std::exchange(noise_factor, refinement.NoiseFactor(inliers, estimate));
    std::vector<bool> selected = refinement.FindInliers(estimate, noise_factor);
    if (std::ranges::none_of(selected, std::identity())) return std::nullopt;
    constexpr double kTolerance = 0.01;  // relative to the standard deviation
    const double sigma_m = std::sqrt(covariance->topLeftCorner<3, 3>().trace());
    const bool converged =
        (estimate.place - before).norm() < kTolerance * sigma_m && std::abs(noise_factor - given) < kTolerance;
    // Without convergence, too, the inliers are those that the place was computed from.
    if ((converged && selected == inliers) || round == kMaxRounds) break;
    inliers = std::move(selected);
  }
  const Eigen::Index unknowns = options.motion == MotionModel::kVelocity ? 6 : 3;
  return RefinedPlace{estimate.motion(), covariance->topLeftCorner(unknowns, unknowns), std::move(inliers)};
}

}  // namespace victorious
