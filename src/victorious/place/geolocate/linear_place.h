// Linear estimators of the object's place: the point nearest to the lines of sight, with or without ranges. Used by
// consensus.h (hypotheses), locate.h (methods `least-squares`, `prior`, `ransac`, `ground`) and refine_place.h
// (covariance terms).
//
// Minimises  sum_i (o + v t_i - y_i)' W_i (o + v t_i - y_i),  W_i = I - (1 - w_i) s_i s_i',  y_i = r_i + range_i s_i,
// where w_i is the weight of the range (0: no range). This is equation 4.2 of the thesis with the distances a_i
// eliminated: a linear system with 3 unknowns, or 6 with velocity.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/place/geolocate/ray.h"

namespace victorious {

/// position east, north, up; heading, boresight side, boresight rise; range factor
inline constexpr int kNumCommonErrors = 7;

/// Standard deviations of the common errors, in that order: metres, radians, a fraction of the range.
Eigen::Matrix<double, kNumCommonErrors, 1> CommonErrorSigmas(const CommonErrorOptions& options);

/// The normal equations, accumulated ray by ray.
class NormalEquations {
 public:
  explicit NormalEquations(bool moving) : unknowns_(moving ? 6 : 3) {}

  void Add(const Ray& ray) { Add(ray, ray.forward, 0); }

  /// Adds the ray with its offset measured perpendicular to `along` (unit vector close to ray.forward), at
  /// `distance_m`.
  void Add(const Ray& ray, const Eigen::Vector3d& along, double distance_m);

  /// Subtracts the spurious information about the distance that noise in the ray's direction contributes.
  /// @param variance  of the direction, rad^2
  void SubtractNoise(const Ray& ray, double variance);

  void Clear();

  /// Returns std::nullopt if the rays do not determine the place (or the velocity).
  [[nodiscard]] std::optional<Motion> Solve() const;

  /// The inverse of the normal matrix, unknowns x unknowns; std::nullopt if it is singular.
  [[nodiscard]] std::optional<Eigen::MatrixXd> Inverse() const;

 private:
  void AddWeight(const Eigen::Matrix3d& weight, double time_s);

  Eigen::Matrix<double, 6, 6> matrix_ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> rhs_ = Eigen::Matrix<double, 6, 1>::Zero();
  int unknowns_;
};

/// The linear solution from the chosen rays; `chosen` has one entry per ray.
std::optional<Motion> SolveLinear(std::span<const Ray> rays, const std::vector<bool>& chosen, bool moving);

/// Iterates the linear solution from `start`, measuring each ray's offset perpendicular to its maximum-likelihood
/// direction (ray.h), until it converges. Removes the bias of SolveLinear along the rays that the rays' own errors
/// cause.
std::optional<Motion> SolveUnbiased(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& start,
                                    const LocateOptions& options);

/// The covariance of these solutions by linear propagation of each ray's own errors and of the common errors. 3 x 3, or
/// 6 x 6 with velocity; std::nullopt if the system is singular.
/// @param estimate_correlation  if true, the part of the rays' own errors that does not show in their scatter counts as
///                              identical in all rays, so that it does not average out (a stationary camera)
std::optional<Eigen::MatrixXd> LinearCovariance(std::span<const Ray> rays, const std::vector<bool>& chosen,
                                                const Motion& motion, const LocateOptions& options,
                                                bool estimate_correlation);

/// Method `prior`: adds the rays one by one in order of time. Rejects a ray if the solution with it leaves the frustum
/// of the ray itself or of a ray already kept. Returns one flag per ray. Quadratic in the number of rays.
std::vector<bool> SelectConsistentRays(std::span<const Ray> rays, bool moving);

}  // namespace victorious
