#include "victorious/place/geolocate/locate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/median.h"
#include "victorious/place/geolocate/consensus.h"
#include "victorious/place/geolocate/error_ellipse.h"
#include "victorious/place/geolocate/linear_place.h"
#include "victorious/place/geolocate/ray.h"
#include "victorious/place/geolocate/refine_place.h"

namespace victorious {
namespace {

// The result of an estimator. The error is the status of a fix without a place.
struct Solution {
  Motion motion;
  Eigen::MatrixXd covariance;  // of the place, followed by the velocity if it is estimated; in the tangent plane
  std::vector<bool> inliers;
};
using Outcome = std::expected<Solution, LocateStatus>;

// kTooUncertain takes the standard deviation and the distance.
constexpr auto kLocateStatusTexts = std::to_array<EnumText<LocateStatus>>({
    {LocateStatus::kOk, "ok"},
    {LocateStatus::kCameraBelowGround, "undetermined: the camera is below the ground"},
    {LocateStatus::kOffTerrain,
     "undetermined: the line of sight leaves the terrain, or intersects it where it has no height"},
    {LocateStatus::kMissesGround, "undetermined: no line of sight intersects the ground"},
    {LocateStatus::kSingleLineVelocity, "undetermined: a single line of sight does not determine a velocity"},
    {LocateStatus::kSingleLineRange, "undetermined: a single line of sight needs a range"},
    {LocateStatus::kTooFewForVelocity,
     "undetermined: too few lines of sight, or too parallel, for a place and a velocity"},
    {LocateStatus::kParallel, "undetermined: the lines of sight are parallel"},
    {LocateStatus::kBehindCamera, "undetermined: the lines of sight meet behind the camera"},
    {LocateStatus::kInconsistent, "undetermined: the lines of sight do not intersect within their errors"},
    {LocateStatus::kDistanceUnobservable,
     "undetermined: the lines of sight differ too little, for their errors, to determine the distance"},
    {LocateStatus::kTooUncertain,
     "undetermined: the lines of sight determine the place only to {:.0f} m (1 sigma) at {:.0f} m"},
});

// A velocity below this over the duration of the lines is not distinguished from 0. Chosen, not
// fitted: within the size of an object.
constexpr double kMinTravel_m = 1;

bool IsMoving(const LocateOptions& options) { return options.motion == MotionModel::kVelocity; }

bool IsMostlyBehind(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion) {
  std::ptrdiff_t behind = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    behind += chosen[i] && (motion.At(rays[i].time_s) - rays[i].camera).dot(rays[i].forward) <= 0 ? 1 : 0;
  }
  return 2 * behind > std::ranges::count(chosen, true);
}

// The reason why the given ground yields no place.
LocateStatus GroundMissStatus(std::span<const Ray> rays) {
  const auto all = [&](GroundMiss why) {
    return std::ranges::all_of(rays, [&](const Ray& ray) { return ray.ground_miss == why; });
  };
  if (all(GroundMiss::kBelow)) return LocateStatus::kCameraBelowGround;
  return all(GroundMiss::kUnknown) ? LocateStatus::kOffTerrain : LocateStatus::kMissesGround;
}

LocateStatus UndeterminedStatus(std::span<const Ray> rays, const std::vector<bool>& chosen,
                                const LocateOptions& options) {
  const auto count = std::ranges::count(chosen, true);
  if (count == 1 && rays.size() > 1) return UndeterminedStatus(rays, std::vector<bool>(rays.size(), true), options);
  if (count == 0) return GroundMissStatus(rays);
  if (count == 1 && IsMoving(options)) return LocateStatus::kSingleLineVelocity;
  if (count == 1 && options.ground && rays.size() == 1) return GroundMissStatus(rays);
  if (count == 1) return LocateStatus::kSingleLineRange;
  const auto motion = SolveLinear(rays, chosen, IsMoving(options));
  if (!motion) return IsMoving(options) ? LocateStatus::kTooFewForVelocity : LocateStatus::kParallel;
  return IsMostlyBehind(rays, chosen, *motion) ? LocateStatus::kBehindCamera : LocateStatus::kInconsistent;
}

struct ExcessUncertainty {
  double sigma_m = 0;
  double distance_m = 0;
};

// Set if the place is too uncertain to report: it might as well be at the camera or at twice the distance.
std::optional<ExcessUncertainty> FindExcessUncertainty(std::span<const Ray> rays, const Solution& solution) {
  double distance_m = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!solution.inliers[i]) continue;
    distance_m = std::max(distance_m, (solution.motion.At(rays[i].time_s) - rays[i].camera).norm());
  }
  const Eigen::Matrix3d covariance = solution.covariance.topLeftCorner<3, 3>();
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(2);
  const double sigma_m = std::sqrt(std::max(0.0, largest));
  if (std::isfinite(sigma_m) && sigma_m <= kMaxErrorFraction * distance_m) return std::nullopt;
  return ExcessUncertainty{sigma_m, distance_m};
}

// True if the lines determine the distance without ranges.
bool IsDistanceObservable(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion,
                          const LocateOptions& options) {
  std::vector<Ray> without_ranges(rays.begin(), rays.end());
  for (Ray& ray : without_ranges) ray.range_weight = 0;
  auto covariance = LinearCovariance(without_ranges, chosen, motion, options, false);
  if (!covariance) return false;
  return !FindExcessUncertainty(without_ranges, {motion, *std::move(covariance), chosen});
}

Outcome SolveWithCovariance(std::span<const Ray> rays, std::vector<bool> chosen, const LocateOptions& options) {
  auto motion = SolveLinear(rays, chosen, IsMoving(options));
  if (!motion || IsMostlyBehind(rays, chosen, *motion))
    return std::unexpected(UndeterminedStatus(rays, chosen, options));
  if (options.method == LocateMethod::kPrior || options.method == LocateMethod::kRansac)
    motion = SolveUnbiased(rays, chosen, *motion, options);
  if (!motion || IsMostlyBehind(rays, chosen, *motion))
    return std::unexpected(UndeterminedStatus(rays, chosen, options));
  const bool is_range_only = std::ranges::all_of(rays, [&](const Ray& ray) {
    return !chosen[static_cast<std::size_t>(&ray - rays.data())] || ray.range_weight == 1;
  });
  const bool estimate_correlation = is_range_only || !IsDistanceObservable(rays, chosen, *motion, options);
  auto covariance = LinearCovariance(rays, chosen, *motion, options, estimate_correlation);
  if (!covariance) return std::unexpected(LocateStatus::kDistanceUnobservable);
  return Solution{*motion, *std::move(covariance), std::move(chosen)};
}

// The solution combined with the constraint that the object is on the ground, by the errors of both. Returns
// std::nullopt if the ground height is not known, or if the place is outside the gate: the object is then not on the
// ground.
std::optional<Solution> ConstrainToGround(Solution solution, const TangentPlane& plane, const LocateOptions& options) {
  constexpr int kRounds = 3;  // the ground patch depends on the place; more rounds change it by less than its sigma
  const Solution unconstrained = solution;
  for (int round = 0; round < kRounds; ++round) {
    const auto patch = GroundPatchAt(*options.ground, plane, solution.motion.place);
    if (!patch) return std::nullopt;
    const Eigen::VectorXd cross_covariance = unconstrained.covariance.leftCols<3>() * patch->normal;
    const double sigma_m = options.ground_sigma_m * VerticalPart(*patch, plane);
    const double variance_m2 = patch->normal.dot(cross_covariance.head<3>()) + sigma_m * sigma_m;
    const double off_m = patch->normal.dot(unconstrained.motion.place - patch->point);
    if (off_m * off_m > options.gate_sigma * options.gate_sigma * variance_m2) return std::nullopt;
    const Eigen::VectorXd step = -off_m / variance_m2 * cross_covariance;
    solution.motion.place = unconstrained.motion.place + step.head<3>();
    if (step.size() == 6) solution.motion.velocity = unconstrained.motion.velocity + step.tail<3>();
    solution.covariance = unconstrained.covariance - cross_covariance * cross_covariance.transpose() / variance_m2;
  }
  return solution;
}

// The mean of the end points of the ranges; the lines' intersection has no weight along them.
Outcome SolveByRanges(std::span<const Ray> rays, std::vector<bool> chosen, const TangentPlane& plane,
                      const LocateOptions& options) {
  std::vector<Ray> ranged(rays.begin(), rays.end());
  bool measured = true;
  for (std::size_t i = 0; i < ranged.size(); ++i) {
    chosen[i] = chosen[i] && ranged[i].range_source != RangeSource::kNone;
    measured = measured && (!chosen[i] || ranged[i].range_source == RangeSource::kMeasured);
    ranged[i].range_weight = 1;
  }
  if (std::ranges::none_of(chosen, std::identity())) {
    return std::unexpected(options.ground ? GroundMissStatus(rays) : LocateStatus::kDistanceUnobservable);
  }
  auto outcome = SolveWithCovariance(ranged, std::move(chosen), options);
  if (!outcome || !measured || !options.ground) return outcome;
  auto on_ground = ConstrainToGround(*outcome, plane, options);
  return on_ground ? Outcome(*std::move(on_ground)) : outcome;
}

Outcome RefineConsensus(std::span<const Ray> rays, const Consensus& start, const TangentPlane& plane,
                        const LocateOptions& options) {
  auto refined = RefinePlace(rays, start.motion, start.inliers, plane, options);
  if (!refined) return std::unexpected(LocateStatus::kDistanceUnobservable);
  if (IsMostlyBehind(rays, refined->inliers, refined->motion)) {
    return std::unexpected(LocateStatus::kBehindCamera);
  }
  return Solution{refined->motion, std::move(refined->covariance), std::move(refined->inliers)};
}

Outcome SolveMaximumLikelihood(std::span<const Ray> rays, Consensus start, const TangentPlane& plane,
                               const LocateOptions& options) {
  if (!IsDistanceObservable(rays, start.inliers, start.motion, options)) {
    return SolveByRanges(rays, std::move(start.inliers), plane, options);
  }
  if (!options.ground) return RefineConsensus(rays, start, plane, options);
  LocateOptions without_ground = options;
  without_ground.ground.reset();
  Outcome unconstrained = RefineConsensus(rays, start, plane, without_ground);
  if (unconstrained && !ConstrainToGround(*unconstrained, plane, options)) return unconstrained;
  return RefineConsensus(rays, start, plane, options);
}

Outcome Solve(std::span<const Ray> rays, const TangentPlane& plane, const LocateOptions& options) {
  std::vector<bool> all(rays.size(), true);
  if (options.method == LocateMethod::kLeastSquares) return SolveWithCovariance(rays, std::move(all), options);
  if (options.method == LocateMethod::kPrior)
    return SolveWithCovariance(rays, SelectConsistentRays(rays, IsMoving(options)), options);
  if (options.method == LocateMethod::kGround) {
    std::transform(rays.begin(), rays.end(), all.begin(),
                   [](const Ray& ray) { return ray.range_source == RangeSource::kGround; });
    return SolveWithCovariance(rays, std::move(all), options);
  }
  auto consensus = FindConsensus(rays, options);
  if (!consensus) return std::unexpected(UndeterminedStatus(rays, all, options));
  if (options.method == LocateMethod::kRansac) return SolveWithCovariance(rays, std::move(consensus->inliers), options);
  return SolveMaximumLikelihood(rays, *std::move(consensus), plane, options);
}

Geolocation MakePlace(const Solution& solution, const TangentPlane& plane, double time_s) {
  const Eigen::Matrix3d rotation = plane.LocalEnuFromEnu(solution.motion.place).toRotationMatrix();
  Geolocation place;
  place.point = plane.GeodeticFromEnu(solution.motion.place);
  place.time_s = time_s;
  place.covariance_enu_m2 = rotation * solution.covariance.topLeftCorner<3, 3>() * rotation.transpose();
  if (solution.covariance.rows() == 6) {
    place.velocity_enu = rotation * solution.motion.velocity;
    place.velocity_covariance_enu = rotation * solution.covariance.bottomRightCorner<3, 3>() * rotation.transpose();
  }
  SetErrorRadii(place);
  return place;
}

// The result for one motion model.
struct LocateResult {
  GeoFix fix;
  std::optional<Motion> motion;  // in the tangent plane; std::nullopt if there is no place
};

LocateResult LocateWithMotion(MotionModel motion, std::span<const LineOfSight> lines, LocateOptions options) {
  options.motion = motion;
  const TangentPlane plane(lines.front().camera);
  const std::vector<Ray> rays = MakeRays(lines, plane, options);
  LocateResult result{.fix = {.inliers = std::vector<bool>(lines.size(), false)}};
  const Outcome outcome = Solve(rays, plane, options);
  if (!outcome) {
    result.fix.status = outcome.error();
    return result;
  }
  if (const auto excess = FindExcessUncertainty(rays, *outcome)) {
    result.fix.status = LocateStatus::kTooUncertain;
    result.fix.rejected_sigma_m = excess->sigma_m;
    result.fix.rejected_distance_m = excess->distance_m;
    return result;
  }
  result.fix.place = MakePlace(*outcome, plane, std::ranges::max(lines, {}, &LineOfSight::time_s).time_s);
  result.fix.inliers = outcome->inliers;
  result.motion = outcome->motion;
  return result;
}

// The rays' offsets from the object, in units of their own errors there.
std::vector<double> NormalisedOffsets(std::span<const Ray> rays, const Motion& motion, const LocateOptions& options) {
  std::vector<double> offsets;
  for (const Ray& ray : rays) {
    const Eigen::Vector3d to_object = motion.At(ray.time_s) - ray.camera;
    const double along_m = to_object.dot(ray.forward);
    const double sigma_m = std::hypot(along_m * ray.sigma_rad, options.line.position_m);
    offsets.push_back(along_m > 0 ? (to_object - along_m * ray.forward).norm() / sigma_m
                                  : std::numeric_limits<double>::infinity());
  }
  return offsets;
}

// Selects the motion model: true if the object moves, by the Bayesian information criterion (Schwarz 1978) over
// truncated squared offsets, scaled by the residual noise of the moving solution; and by more than kMinTravel_m.
bool SelectsMoving(std::span<const LineOfSight> lines, const LocateResult& stationary, const LocateResult& moving,
                   const LocateOptions& options) {
  if (!moving.fix.place) return false;
  const std::vector<Ray> rays = MakeRays(lines, TangentPlane(lines.front().camera), options);
  const double first_s = std::ranges::min(rays, {}, &Ray::time_s).time_s;
  if (moving.motion->velocity.norm() * -first_s < kMinTravel_m) return false;
  if (!stationary.fix.place) return true;
  const std::vector<double> stationary_offsets = NormalisedOffsets(rays, *stationary.motion, options);
  const std::vector<double> moving_offsets = NormalisedOffsets(rays, *moving.motion, options);
  const double factor = std::max(1.0, Median(moving_offsets) / kRayleighMedian);
  const auto cost = [&](const std::vector<double>& offsets) {
    double sum = 0;
    for (const double offset : offsets) sum += std::pow(std::min(offset / factor, options.gate_sigma), 2);
    return sum;
  };
  constexpr double kUnknowns = 3;  // of the velocity
  return cost(stationary_offsets) - cost(moving_offsets) >
         kUnknowns * std::log(2.0 * static_cast<double>(lines.size()));
}

// Motion `auto`. A static object gets velocity 0, with the velocity covariance of the moving solution.
GeoFix LocateWithModelSelection(std::span<const LineOfSight> lines, const LocateOptions& options) {
  LocateResult stationary = LocateWithMotion(MotionModel::kStatic, lines, options);
  const LocateResult moving = LocateWithMotion(MotionModel::kVelocity, lines, options);
  if (SelectsMoving(lines, stationary, moving, options)) return moving.fix;
  if (stationary.fix.place && moving.fix.place) {
    stationary.fix.place->velocity_enu = Eigen::Vector3d::Zero();
    stationary.fix.place->velocity_covariance_enu = moving.fix.place->velocity_covariance_enu;
  }
  return stationary.fix;
}

}  // namespace

std::string StatusText(const GeoFix& fix) {
  return fmt::format(fmt::runtime(ToText(kLocateStatusTexts, fix.status)), fix.rejected_sigma_m,
                     fix.rejected_distance_m);
}

Expected<GeoFix> Locate(std::span<const LineOfSight> lines, const LocateOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (lines.empty()) return Fail(ErrorCode::kInvalidArgument, "no lines of sight: give at least one");
  if (options.method == LocateMethod::kGround && !options.ground) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "the method ground needs a ground: give its height (--ground METRES) or a terrain (--terrain FILE.tif)");
  }
  return LocateChecked(lines, options);
}

GeoFix LocateChecked(std::span<const LineOfSight> lines, const LocateOptions& options) {
  VICTORIOUS_CHECK(!lines.empty());
  if (options.motion == MotionModel::kAuto) return LocateWithModelSelection(lines, options);
  return LocateWithMotion(options.motion, lines, options).fix;
}

}  // namespace victorious
