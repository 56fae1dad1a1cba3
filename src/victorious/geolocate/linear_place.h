// The linear estimators: the point nearest to lines, with or without ranges along them.
//
// Minimises  sum_i (o + v t_i - y_i)' W_i (o + v t_i - y_i),  W_i = I - (1 - w_i) s_i s_i',  y_i = r_i + range_i s_i,
// where w_i is the weight of the range (0: none). This is equation 4.2 of the thesis with the distances a_i eliminated:
// a system of 3, with velocity of 6, unknowns.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/geolocate/ray.h"

namespace victorious {

inline constexpr int kCommonErrors = 7;  ///< east, north, up; heading, side, rise; range factor

/// Their standard deviations: metres, radians, a share.
Eigen::Matrix<double, kCommonErrors, 1> CommonSigmas(const CommonErrorOptions& options);

/// The normal equations, grown ray by ray.
class NormalSystem {
 public:
  explicit NormalSystem(bool moving) : unknowns_(moving ? 6 : 3) {}

  void Add(const Ray& ray) { Add(ray, ray.forward, 0); }

  /// The ray across another direction, near its own: its offset is then measured at `distance_m`.
  void Add(const Ray& ray, const Eigen::Vector3d& along, double distance_m);

  /// Takes off what a direction's variance, rad^2, feigns to tell of the distance.
  void Discount(const Ray& ray, double variance);

  void Clear();

  /// Nothing where the rays leave a direction (or a velocity) open.
  [[nodiscard]] std::optional<Motion> Solve() const;

  /// The inverse of the system's matrix; unknowns x unknowns.
  [[nodiscard]] std::optional<Eigen::MatrixXd> Inverse() const;

 private:
  void AddWeight(const Eigen::Matrix3d& weight, double time_s);

  Eigen::Matrix<double, 6, 6> matrix_ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right_ = Eigen::Matrix<double, 6, 1>::Zero();
  int unknowns_;
};

/// The solution over the chosen rays.
std::optional<Motion> SolveLinear(std::span<const Ray> rays, const std::vector<bool>& chosen, bool moving);

/// Solves again from `start`, each ray across its likely direction (ray.h) until nothing changes: without the pull
/// along the rays that their own errors have on SolveLinear.
std::optional<Motion> SolveBalanced(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& start,
                                    const LocateOptions& options);

/// The covariance of these solutions: each ray's own errors, and the common ones, carried through the system.
/// @param as_one  the rays are as good as one: what their scatter does not show of their own errors is alike in all of
///                them, and does not average out
std::optional<Eigen::MatrixXd> LinearCovariance(std::span<const Ray> rays, const std::vector<bool>& chosen,
                                                const Motion& motion, const LocateOptions& options, bool as_one);

/// Method `prior`: ray by ray in order of time; one that would pull the solution out of a kept ray's frustum, or lies
/// apart from it, is left out.
std::vector<bool> KeepWithinFrusta(std::span<const Ray> rays, bool moving);

}  // namespace victorious
