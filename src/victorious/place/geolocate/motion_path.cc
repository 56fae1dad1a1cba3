#include "victorious/place/geolocate/motion_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/base/median.h"
#include "victorious/place/geolocate/error_ellipse.h"
#include "victorious/place/geolocate/path_smoother.h"
#include "victorious/place/geolocate/ray.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMinLines = 3;
constexpr std::size_t kMaxLines = 1000;  // of longer tracks every n-th line is used
// A shorter way is within the size of an object (locate.cc), or within the error of a range, which changes with the
// view.
constexpr double kMinTravel_m = 1;
constexpr double kMinTravelFraction = 0.015;
constexpr double kSpeedSigma_m_s = 20;
// A vehicle's own noise, however exact the camera: its pose changes from view to view, its way is not quite smooth. A
// fit that trusts its lines more takes that for manoeuvres, or for outliers.
constexpr double kMinPosition_m = 0.1;
// Vehicles climb by a few per cent of their speed; where that does not fit, the object flies.
constexpr double kClimbSigma_m_s = 0.5;
constexpr double kRoadDensity = 0.01;
constexpr double kFlightDensity = 1;
constexpr double kMaxCorrelation = 0.6;  // of successive residuals: beyond it they show a lack of fit

PathModel Driving() {
  return {.speed_sigma_m_s = kSpeedSigma_m_s,
          .climb_sigma_m_s = kClimbSigma_m_s,
          .vertical_density = kRoadDensity,
          .manoeuvres = true};
}

PathModel Flying() {
  return {.speed_sigma_m_s = kSpeedSigma_m_s,
          .climb_sigma_m_s = kSpeedSigma_m_s,
          .vertical_density = kFlightDensity,
          .manoeuvres = true};
}

struct NoiseFactors {
  double angle = 1;
  double range = 1;
};

NoiseFactors FactorsOf(const PathFit& fit) { return {fit.angle_factor, fit.range_factor}; }

// Truncated squared residuals, and the squared common errors that the fit uses.
double Cost(const PathFit& fit, const NoiseFactors& noise, double gate_sigma) {
  double cost = fit.means.front().tail<kPathUnknowns - 6>().squaredNorm();
  const double most = gate_sigma * gate_sigma;
  for (const PathResidual& residual : fit.residuals) {
    cost += std::min(most, (residual.side * residual.side + residual.rise * residual.rise) / std::pow(noise.angle, 2));
    cost += std::min(most, std::pow(residual.range / noise.range, 2));
  }
  return cost;
}

// The number of successive residuals that count as one: (1 + r) / (1 - r) for the correlation r of neighbours.
double CorrelationFactor(const PathFit& fit, const NoiseFactors& noise, double gate_sigma) {
  double squares = 0;
  double products = 0;
  const auto component = [&](std::size_t i, int k) {
    const PathResidual& residual = fit.residuals[i];
    const double value =
        k == 0 ? residual.side / noise.angle : (k == 1 ? residual.rise / noise.angle : residual.range / noise.range);
    return std::clamp(value, -gate_sigma, gate_sigma);
  };
  for (std::size_t i = 1; i < fit.residuals.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      products += component(i, k) * component(i - 1, k);
      squares += (std::pow(component(i, k), 2) + std::pow(component(i - 1, k), 2)) / 2;
    }
  }
  const double correlation = squares > 0 ? std::clamp(products / squares, 0.0, kMaxCorrelation) : 0;
  return (1 + correlation) / (1 - correlation);
}

double Travel(const PathFit& fit) {
  double farthest_m = 0;
  for (const PathVector& mean : fit.means)
    farthest_m = std::max(farthest_m, (mean - fit.means.front()).head<3>().norm());
  return farthest_m;
}

// True if `moving` explains the rays better than `still`, beyond its additional unknowns.
bool IsBetter(const PathFit& moving, const PathFit& still, double unknowns, double gate_sigma) {
  const NoiseFactors noise = FactorsOf(moving);
  const double gain = Cost(still, noise, gate_sigma) - Cost(moving, noise, gate_sigma);
  const double rows = 2.0 * static_cast<double>(moving.means.size());
  return gain / CorrelationFactor(still, noise, gate_sigma) > unknowns * std::log(rows);
}

// A path in the air if that explains the rays better than one along a road.
PathFit FitMovingPath(std::span<const Ray> rays, const TangentPlane& plane, const LocateOptions& options) {
  PathFit driving = FitPath(rays, plane, Driving(), options);
  PathFit flying = FitPath(rays, plane, Flying(), options);
  constexpr double kClimbUnknowns = 1;
  const double more = std::max(0.0, flying.manoeuvre_unknowns - driving.manoeuvre_unknowns);
  return IsBetter(flying, driving, kClimbUnknowns + more, options.gate_sigma) ? std::move(flying) : std::move(driving);
}

// The path on the ground, if that is given and within the gate of the path that does not use it.
PathFit ConstrainToGround(PathFit fit, std::span<const Ray> rays, const TangentPlane& plane,
                          const LocateOptions& options) {
  if (!options.ground) return fit;
  std::vector<double> off_sigmas;
  for (std::size_t i = 0; i < fit.means.size(); ++i) {
    const auto patch = GroundPatchAt(*options.ground, plane, fit.means[i].head<3>());
    if (!patch) return fit;
    const Vector3d normal = patch->normal;
    const double variance_m2 =
        normal.dot(fit.covariances[i].topLeftCorner<3, 3>() * normal) + std::pow(options.ground_sigma_m, 2);
    off_sigmas.push_back(std::abs(normal.dot(fit.means[i].head<3>() - patch->point)) / std::sqrt(variance_m2));
  }
  if (Median(off_sigmas) > options.gate_sigma) return fit;
  PathModel on_ground = Driving();
  on_ground.ground = options.ground.get();
  on_ground.ground_sigma_m = options.ground_sigma_m;
  return FitPath(rays, plane, on_ground, options);
}

Geolocation MakePlace(const PathVector& mean, const PathMatrix& covariance, double time_s, const TangentPlane& plane) {
  const Eigen::Matrix3d rotation = plane.LocalEnuFromEnu(mean.head<3>()).toRotationMatrix();
  Geolocation place;
  place.point = plane.GeodeticFromEnu(mean.head<3>());
  place.time_s = time_s;
  place.covariance_enu_m2 = rotation * covariance.topLeftCorner<3, 3>() * rotation.transpose();
  place.velocity_enu = rotation * mean.segment<3>(3);
  place.velocity_covariance_enu = rotation * covariance.block<3, 3>(3, 3) * rotation.transpose();
  SetErrorRadii(place);
  return place;
}

// True if the ray passes the path within the gate or the identity radius, at its range. Lines that scatter by more than
// three times their sigmas have no path.
bool IsNear(const Ray& ray, const PathFit& fit, std::size_t i, const LocateOptions& options) {
  constexpr double kMaxFactor = 3;
  const double distance_m = (fit.means[i].head<3>() - ray.camera).norm();
  if (distance_m < ray.frustum.nearest_m || distance_m > ray.frustum.farthest_m) return false;
  const double sigma_m = std::hypot(distance_m * ray.sigma_rad, options.line.position_m);
  const double off_m = sigma_m * std::hypot(fit.residuals[i].side, fit.residuals[i].rise);
  return off_m <=
         std::hypot(options.gate_sigma * std::min(kMaxFactor, fit.angle_factor) * sigma_m, options.identity_radius_m);
}

// 0 for a path shorter than kInterval_s.
double MedianAcceleration(std::span<const Ray> rays, const PathFit& fit) {
  constexpr double kInterval_s = 0.5;
  std::vector<double> accelerations;
  std::size_t later = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    while (later < rays.size() && rays[later].time_s < rays[i].time_s + kInterval_s) ++later;
    if (later == rays.size()) break;
    const Vector3d change = (fit.means[later] - fit.means[i]).segment<3>(3);
    accelerations.push_back(change.norm() / (rays[later].time_s - rays[i].time_s));
  }
  return MedianOr(std::move(accelerations), 0);
}

// Every n-th line, such that at most kMaxLines remain, and the last.
std::vector<std::size_t> SelectLines(std::size_t count) {
  const std::size_t step = (count + kMaxLines - 1) / kMaxLines;
  std::vector<std::size_t> selected;
  for (std::size_t i = 0; i < count; i += step) selected.push_back(i);
  if (selected.back() + 1 != count) selected.push_back(count - 1);
  return selected;
}

}  // namespace

std::optional<MotionPath> EstimatePath(std::span<const LineOfSight> lines, const LocateOptions& given) {
  LocateOptions options = given;
  options.line.position_m = std::max(options.line.position_m, kMinPosition_m);
  if (lines.size() < kMinLines) return std::nullopt;
  if (!std::ranges::all_of(lines, [](const LineOfSight& line) { return line.range_m.has_value(); })) {
    return std::nullopt;
  }
  const std::vector<std::size_t> selected = SelectLines(lines.size());
  std::vector<LineOfSight> used;
  for (const std::size_t i : selected) used.push_back(lines[i]);
  const TangentPlane plane(used.front().camera);
  const std::vector<Ray> rays = MakeRays(used, plane, options);
  PathFit fit = FitMovingPath(rays, plane, options);
  const PathFit still = FitPath(rays, plane, StaticPath(), options);
  constexpr double kVelocityUnknowns = 3;
  const double min_travel_m = std::max(kMinTravel_m, kMinTravelFraction * rays.front().range_m);
  MotionPath path;
  path.is_moving = options.motion == MotionModel::kVelocity ||
                   (Travel(fit) > min_travel_m &&
                    IsBetter(fit, still, kVelocityUnknowns + fit.manoeuvre_unknowns, options.gate_sigma));
  if (path.is_moving) fit = ConstrainToGround(std::move(fit), rays, plane, options);
  const PathFit& chosen = path.is_moving ? fit : still;
  std::vector<bool> near;
  for (std::size_t i = 0; i < rays.size(); ++i) near.push_back(IsNear(rays[i], chosen, i, options));
  std::size_t next = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    while (selected[next] < i) ++next;
    path.inliers.push_back(near[next]);
  }
  if (!path.is_moving) return path;
  path.acceleration_m_s2 = MedianAcceleration(rays, fit);
  for (std::size_t i = 0; i < rays.size(); ++i)
    path.places.push_back(MakePlace(fit.means[i], fit.covariances[i], used[i].time_s, plane));
  return path;
}

}  // namespace victorious
