#include "victorious/geolocate/locate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/geolocate/consensus.h"
#include "victorious/geolocate/error_ellipse.h"
#include "victorious/geolocate/linear_place.h"
#include "victorious/geolocate/ray.h"
#include "victorious/geolocate/refine_place.h"

namespace victorious {
namespace {

// The result of an estimator. The error is the status of a fix without a place.
struct Solution {
  Motion motion;
  Eigen::MatrixXd covariance;  // of the place, followed by the velocity if it is estimated; in the tangent plane
  std::vector<bool> inliers;
};
using Outcome = std::expected<Solution, std::string>;

constexpr const char* kNoBaseline =
    "undetermined: the lines of sight differ too little, for their errors, to determine the distance";

bool Moving(const LocateOptions& options) { return options.motion == "velocity"; }

bool MostlyBehind(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion) {
  std::ptrdiff_t behind = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    behind += chosen[i] && (motion.At(rays[i].time_s) - rays[i].camera).dot(rays[i].forward) <= 0 ? 1 : 0;
  }
  return 2 * behind > std::ranges::count(chosen, true);
}

// The reason why the given ground yields no place.
std::string WhyNoGround(std::span<const Ray> rays) {
  const auto all = [&](NoGround why) {
    return std::ranges::all_of(rays, [&](const Ray& ray) { return ray.no_ground == why; });
  };
  if (all(NoGround::kBelow)) return "undetermined: the camera is below the ground";
  if (all(NoGround::kUnknown))
    return "undetermined: the line of sight leaves the terrain, or intersects it where it has no height";
  return "undetermined: no line of sight intersects the ground";
}

std::string WhyOpen(std::span<const Ray> rays, const std::vector<bool>& chosen, const LocateOptions& options) {
  const auto count = std::ranges::count(chosen, true);
  if (count == 1 && rays.size() > 1) return WhyOpen(rays, std::vector<bool>(rays.size(), true), options);
  if (count == 0) return WhyNoGround(rays);
  if (count == 1 && Moving(options)) return "undetermined: a single line of sight does not determine a velocity";
  if (count == 1 && options.ground && rays.size() == 1) return WhyNoGround(rays);
  if (count == 1) return "undetermined: a single line of sight needs a range";
  const auto motion = SolveLinear(rays, chosen, Moving(options));
  if (!motion) {
    return Moving(options) ? "undetermined: too few lines of sight, or too parallel, for a place and a velocity"
                           : "undetermined: the lines of sight are parallel";
  }
  if (MostlyBehind(rays, chosen, *motion)) return "undetermined: the lines of sight meet behind the camera";
  return "undetermined: the lines of sight do not intersect within their errors";
}

// The status if the place is too uncertain to report: it might as well be at the camera or at twice the distance.
std::optional<std::string> WhyTooUncertain(std::span<const Ray> rays, const Solution& solution, double largest_share) {
  double distance_m = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!solution.inliers[i]) continue;
    distance_m = std::max(distance_m, (solution.motion.At(rays[i].time_s) - rays[i].camera).norm());
  }
  const Eigen::Matrix3d covariance = solution.covariance.topLeftCorner<3, 3>();
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(2);
  const double sigma_m = std::sqrt(std::max(0.0, largest));
  if (std::isfinite(sigma_m) && sigma_m <= largest_share * distance_m) return std::nullopt;
  return fmt::format("undetermined: the lines of sight determine the place only to {:.0f} m (1 sigma) at {:.0f} m",
                     sigma_m, distance_m);
}

// True if the lines determine the distance without ranges.
bool TellDistance(std::span<const Ray> rays, const std::vector<bool>& chosen, const Motion& motion,
                  const LocateOptions& options) {
  std::vector<Ray> blind(rays.begin(), rays.end());
  for (Ray& ray : blind) ray.range_weight = 0;
  auto covariance = LinearCovariance(blind, chosen, motion, options, false);
  if (!covariance) return false;
  return !WhyTooUncertain(blind, {motion, *std::move(covariance), chosen}, options.largest_error_share);
}

Outcome SolveOver(std::span<const Ray> rays, std::vector<bool> chosen, const LocateOptions& options) {
  auto motion = SolveLinear(rays, chosen, Moving(options));
  if (!motion || MostlyBehind(rays, chosen, *motion)) return std::unexpected(WhyOpen(rays, chosen, options));
  if (options.method == "prior" || options.method == "ransac") motion = SolveBalanced(rays, chosen, *motion, options);
  if (!motion || MostlyBehind(rays, chosen, *motion)) return std::unexpected(WhyOpen(rays, chosen, options));
  const bool by_ranges = std::ranges::all_of(rays, [&](const Ray& ray) {
    return !chosen[static_cast<std::size_t>(&ray - rays.data())] || ray.range_weight == 1;
  });
  const bool as_one = by_ranges || !TellDistance(rays, chosen, *motion, options);
  auto covariance = LinearCovariance(rays, chosen, *motion, options, as_one);
  if (!covariance) return std::unexpected(kNoBaseline);
  return Solution{*motion, *std::move(covariance), std::move(chosen)};
}

// The solution combined with the constraint that the object is on the ground, by the errors of both. Returns
// std::nullopt if the ground height is not known, or if the place is outside the gate: the object is then not on the
// ground.
std::optional<Solution> OnGround(Solution solution, const TangentPlane& plane, const LocateOptions& options) {
  constexpr int kRounds = 3;  // the ground patch depends on the place
  const Solution told = solution;
  for (int round = 0; round < kRounds; ++round) {
    const auto patch = PatchBelow(*options.ground, plane, solution.motion.place);
    if (!patch) return std::nullopt;
    const Eigen::VectorXd gain = told.covariance.leftCols<3>() * patch->normal;
    const double sigma_m = options.ground_sigma_m * (plane.LocalEnuFromEnu(patch->point) * patch->normal).z();
    const double variance_m2 = patch->normal.dot(gain.head<3>()) + sigma_m * sigma_m;
    const double off_m = patch->normal.dot(told.motion.place - patch->point);
    if (off_m * off_m > options.gate_sigma * options.gate_sigma * variance_m2) return std::nullopt;
    const Eigen::VectorXd moved = -off_m / variance_m2 * gain;
    solution.motion.place = told.motion.place + moved.head<3>();
    if (moved.size() == 6) solution.motion.velocity = told.motion.velocity + moved.tail<3>();
    solution.covariance = told.covariance - gain * gain.transpose() / variance_m2;
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
    return std::unexpected(options.ground ? WhyNoGround(rays) : kNoBaseline);
  }
  auto outcome = SolveOver(ranged, std::move(chosen), options);
  if (!outcome || !measured || !options.ground) return outcome;
  auto on_ground = OnGround(*outcome, plane, options);
  return on_ground ? Outcome(*std::move(on_ground)) : outcome;
}

Outcome Refined(std::span<const Ray> rays, const Consensus& start, const TangentPlane& plane,
                const LocateOptions& options) {
  auto refined = RefinePlace(rays, start.motion, start.inliers, plane, options);
  if (!refined) return std::unexpected(kNoBaseline);
  if (MostlyBehind(rays, refined->inliers, refined->motion)) {
    return std::unexpected("undetermined: the lines of sight meet behind the camera");
  }
  return Solution{refined->motion, std::move(refined->covariance), std::move(refined->inliers)};
}

Outcome SolveMostLikely(std::span<const Ray> rays, Consensus start, const TangentPlane& plane,
                        const LocateOptions& options) {
  if (!TellDistance(rays, start.inliers, start.motion, options)) {
    return SolveByRanges(rays, std::move(start.inliers), plane, options);
  }
  if (!options.ground) return Refined(rays, start, plane, options);
  LocateOptions anywhere = options;
  anywhere.ground.reset();
  Outcome free = Refined(rays, start, plane, anywhere);
  if (free && !OnGround(*free, plane, options)) return free;
  return Refined(rays, start, plane, options);
}

Outcome Solve(std::span<const Ray> rays, const TangentPlane& plane, const LocateOptions& options) {
  std::vector<bool> all(rays.size(), true);
  if (options.method == "least-squares") return SolveOver(rays, std::move(all), options);
  if (options.method == "prior") return SolveOver(rays, KeepWithinFrusta(rays, Moving(options)), options);
  if (options.method == "ground") {
    std::transform(rays.begin(), rays.end(), all.begin(),
                   [](const Ray& ray) { return ray.range_source == RangeSource::kGround; });
    return SolveOver(rays, std::move(all), options);
  }
  auto consensus = FindConsensus(rays, options);
  if (!consensus) return std::unexpected(WhyOpen(rays, all, options));
  if (options.method == "ransac") return SolveOver(rays, std::move(consensus->inliers), options);
  return SolveMostLikely(rays, *std::move(consensus), plane, options);
}

Place PlaceOf(const Solution& solution, const TangentPlane& plane, double time_s) {
  const Eigen::Matrix3d turn = plane.LocalEnuFromEnu(solution.motion.place).toRotationMatrix();
  Place place;
  place.point = plane.GeodeticFromEnu(solution.motion.place);
  place.time_s = time_s;
  place.covariance_enu_m2 = turn * solution.covariance.topLeftCorner<3, 3>() * turn.transpose();
  if (solution.covariance.rows() == 6) {
    place.velocity_enu = turn * solution.motion.velocity;
    place.velocity_covariance_enu = turn * solution.covariance.bottomRightCorner<3, 3>() * turn.transpose();
  }
  constexpr double kShare = 0.9;
  place.ce90_m = CircularError(place.covariance_enu_m2.topLeftCorner<2, 2>(), kShare);
  place.le90_m = LinearError90(place.covariance_enu_m2(2, 2));
  return place;
}

// The result for one motion model.
struct Located {
  GeoFix fix;
  std::optional<Motion> motion;  // in the tangent plane; std::nullopt if there is no place
};

Located LocateAs(const std::string& motion, std::span<const LineOfSight> lines, LocateOptions options) {
  options.motion = motion;
  const TangentPlane plane(lines.front().camera);
  const std::vector<Ray> rays = MakeRays(lines, plane, options);
  Located located{.fix = {.inliers = std::vector<bool>(lines.size(), false)}};
  const Outcome outcome = Solve(rays, plane, options);
  if (!outcome) {
    located.fix.status = outcome.error();
    return located;
  }
  if (auto why = WhyTooUncertain(rays, *outcome, options.largest_error_share)) {
    located.fix.status = *std::move(why);
    return located;
  }
  located.fix.place = PlaceOf(*outcome, plane, std::ranges::max(lines, {}, &LineOfSight::time_s).time_s);
  located.fix.inliers = outcome->inliers;
  located.fix.status = "ok";
  located.motion = outcome->motion;
  return located;
}

// The rays' offsets from the object, in units of their own errors there.
std::vector<double> OffsetsFrom(std::span<const Ray> rays, const Motion& motion, const LocateOptions& options) {
  std::vector<double> offsets;
  for (const Ray& ray : rays) {
    const Eigen::Vector3d seen = motion.At(ray.time_s) - ray.camera;
    const double along_m = seen.dot(ray.forward);
    const double sigma_m = std::hypot(along_m * ray.sigma_rad, options.line.position_m);
    offsets.push_back(along_m > 0 ? (seen - along_m * ray.forward).norm() / sigma_m
                                  : std::numeric_limits<double>::infinity());
  }
  return offsets;
}

// Selects the motion model: true if the object moves, by the Bayesian information criterion (Schwarz 1978) over
// truncated squared offsets, scaled by the residual noise of the moving solution; and by more than `min_travel_m`.
bool Moves(std::span<const LineOfSight> lines, const Located& standing, const Located& moving,
           const LocateOptions& options) {
  if (!moving.fix.place) return false;
  const std::vector<Ray> rays = MakeRays(lines, TangentPlane(lines.front().camera), options);
  const double first_s = std::ranges::min(rays, {}, &Ray::time_s).time_s;
  if (moving.motion->velocity.norm() * -first_s < options.least_travel_m) return false;
  if (!standing.fix.place) return true;
  const std::vector<double> of_standing = OffsetsFrom(rays, *standing.motion, options);
  const std::vector<double> of_moving = OffsetsFrom(rays, *moving.motion, options);
  const double factor = std::max(1.0, Median(of_moving) / kRayleighMedian);
  const auto cost = [&](const std::vector<double>& offsets) {
    double sum = 0;
    for (const double offset : offsets) sum += std::pow(std::min(offset / factor, options.gate_sigma), 2);
    return sum;
  };
  constexpr double kUnknowns = 3;  // of the velocity
  return cost(of_standing) - cost(of_moving) > kUnknowns * std::log(2.0 * static_cast<double>(lines.size()));
}

// Motion `auto`. A static object gets velocity 0, with the velocity covariance of the moving solution.
GeoFix LocateByEvidence(std::span<const LineOfSight> lines, const LocateOptions& options) {
  Located standing = LocateAs("static", lines, options);
  const Located moving = LocateAs("velocity", lines, options);
  if (Moves(lines, standing, moving, options)) return moving.fix;
  if (standing.fix.place && moving.fix.place) {
    standing.fix.place->velocity_enu = Eigen::Vector3d::Zero();
    standing.fix.place->velocity_covariance_enu = moving.fix.place->velocity_covariance_enu;
  }
  return standing.fix;
}

}  // namespace

Expected<GeoFix> Locate(std::span<const LineOfSight> lines, const LocateOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  if (lines.empty()) return Fail(ErrorCode::kInvalidArgument, "no lines of sight: give at least one");
  if (options.method == "ground" && !options.ground) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "the method ground needs a ground: give its height (--ground METRES) or a terrain (--terrain FILE.tif)");
  }
  if (options.motion == "auto") return LocateByEvidence(lines, options);
  return LocateAs(options.motion, lines, options).fix;
}

}  // namespace victorious
