#include "victorious/lab/simulate/flight_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/attitude.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

template <typename Value>
Value CatmullRom(const Value& before, const Value& from, const Value& to, const Value& after, double t) {
  const Value linear = (to - before) * 0.5;
  const Value square = before - 2.5 * from + 2.0 * to - 0.5 * after;
  const Value cube = 0.5 * (after - before) + 1.5 * (from - to);
  return from + t * (linear + t * (square + t * cube));
}

// Interpolates the knots at a fraction of the flight. The spline is extrapolated linearly by one knot at each end.
template <typename Value>
Value TrackAt(const std::vector<Value>& knots, double fraction, PathInterpolation interpolation) {
  if (knots.size() == 1) return knots.front();
  const auto last = static_cast<int>(knots.size()) - 1;
  const double at = std::clamp(fraction, 0.0, 1.0) * last;
  const int from = std::min(static_cast<int>(at), last - 1);
  const double t = at - from;
  const auto knot = [&](int i) -> Value {
    if (i < 0) return 2.0 * knots.front() - knots[1];
    if (i > last) return 2.0 * knots.back() - knots[knots.size() - 2];
    return knots[static_cast<std::size_t>(i)];
  };
  if (interpolation == PathInterpolation::kLinear) return knot(from) + t * (knot(from + 1) - knot(from));
  return CatmullRom<Value>(knot(from - 1), knot(from), knot(from + 1), knot(from + 2), t);
}

// A sum of two sines with root mean square 1 over a long time.
double Sway(double time_s, double hz, Random& random) {
  constexpr double kGoldenRatio = 1.6180339887498949;
  const double first = std::sin(2 * kPi * (hz * time_s + random.Uniform()));
  const double second = std::sin(2 * kPi * (hz * kGoldenRatio * time_s + random.Uniform()));
  return first * 0.8 * std::numbers::sqrt2 + second * 0.6 * std::numbers::sqrt2;
}

Eigen::Quaterniond ComputeShake(const SceneCamera& camera, double time_s, std::uint64_t seed) {
  Random random(seed);
  Vector3d turn;
  for (double& angle : turn) angle = RadiansFromDegrees(camera.shake_deg) * Sway(time_s, camera.shake_hz, random);
  return Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
}

// The point at arc length `distance_m` from the first point of the path; extrapolated linearly at both ends.
Vector2d PointAlong(std::span<const Vector2d> path, double distance_m) {
  Vector2d direction = Vector2d::Zero();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector2d way = path[i + 1] - path[i];
    const double length = way.norm();
    if (length == 0) continue;  // repeated point
    direction = way / length;
    if (distance_m <= length) return path[i] + direction * distance_m;
    distance_m -= length;
  }
  return path.back() + direction * distance_m;
}

double PathLength(std::span<const Vector2d> path) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) length += (path[i + 1] - path[i]).norm();
  return length;
}

// Slopes of a monotone cubic through points (Fritsch and Carlson 1980): 0 beside a level section, else the weighted
// harmonic mean of the slopes of the two sections; at the ends, that of the section.
std::vector<double> MonotoneSlopes(std::span<const double> at, std::span<const double> values) {
  const std::size_t sections = at.size() - 1;
  const auto step = [&](std::size_t i) { return at[i + 1] - at[i]; };
  const auto slope = [&](std::size_t i) { return (values[i + 1] - values[i]) / step(i); };
  std::vector<double> slopes(at.size(), 0);
  slopes.front() = slope(0);
  slopes.back() = slope(sections - 1);
  for (std::size_t i = 1; i < sections; ++i) {
    if (slope(i - 1) <= 0 || slope(i) <= 0) continue;
    const double before = step(i - 1) + 2 * step(i);
    const double after = 2 * step(i - 1) + step(i);
    slopes[i] = (before + after) / (before / slope(i - 1) + after / slope(i));
  }
  return slopes;
}

// The distance driven along a path with times, from its first point.
double DistanceAt(const SceneObject& object, double time_s) {
  const std::vector<double>& times_s = object.times_s;
  if (time_s <= times_s.front()) return 0;
  std::vector<double> driven_m = {0};
  for (std::size_t i = 1; i < object.path_m.size(); ++i)
    driven_m.push_back(driven_m.back() + (object.path_m[i] - object.path_m[i - 1]).norm());
  if (time_s >= times_s.back()) return driven_m.back();
  const std::vector<double> slopes = MonotoneSlopes(times_s, driven_m);
  const auto i = static_cast<std::size_t>(std::ranges::upper_bound(times_s, time_s) - times_s.begin()) - 1;
  const double section_s = times_s[i + 1] - times_s[i];
  const double t = (time_s - times_s[i]) / section_s;
  const double u = 1 - t;
  return driven_m[i] * (1 + 2 * t) * u * u + driven_m[i + 1] * (3 - 2 * t) * t * t +
         section_s * t * u * (slopes[i] * u - slopes[i + 1] * t);
}

double HeadingFromDirection(const Vector2d& direction) { return std::atan2(direction.x(), direction.y()); }

}  // namespace

PinholeCamera MakePinhole(const SceneVideo& video) {
  return CentredPinhole(RadiansFromDegrees(video.hfov_deg), video.width, video.height);
}

Rigid3 CameraFromTown(const SceneCamera& camera, double fraction, double time_s, std::uint64_t seed) {
  const Vector2d aim = TrackAt(camera.aim_m, fraction, camera.path);
  const double from = RadiansFromDegrees(TrackAt(camera.from_deg, fraction, camera.path));
  // A spline may overshoot its knots.
  const double off_nadir = RadiansFromDegrees(
      std::clamp(TrackAt(camera.off_nadir_deg, fraction, camera.path), kOffNadirDeg.low, kOffNadirDeg.high));
  const double range_m = std::clamp(TrackAt(camera.range_m, fraction, camera.path), kRangeM.low, kRangeM.high);
  const Vector3d to_camera(std::sin(off_nadir) * std::sin(from), std::sin(off_nadir) * std::cos(from),
                           std::cos(off_nadir));
  const Vector3d place = Vector3d(aim.x(), aim.y(), 0) + range_m * to_camera;
  // The town frame takes the role of east-north-up in CameraFromEnu().
  const Attitude attitude{.yaw_rad = from + kPi,
                          .pitch_rad = off_nadir - kPi / 2,
                          .roll_rad = RadiansFromDegrees(TrackAt(camera.roll_deg, fraction, camera.path))};
  const Eigen::Quaterniond turn = ComputeShake(camera, time_s, seed) * CameraFromEnu(attitude);
  return {turn.normalized(), -(turn * place)};
}

GroundPose ComputeGroundPose(const SceneObject& object, double length_m, double time_s) {
  if (object.path_m.empty()) return {{object.x_m, object.y_m}, RadiansFromDegrees(object.heading_deg)};
  const double driven_m = object.times_s.empty() ? std::min(object.speed_m_s * time_s, PathLength(object.path_m))
                                                 : DistanceAt(object, time_s);
  const Vector2d rear = PointAlong(object.path_m, driven_m - length_m / 2);
  const Vector2d front = PointAlong(object.path_m, driven_m + length_m / 2);
  return {(rear + front) / 2, HeadingFromDirection(front - rear)};
}

Eigen::Vector2d ComputeGroundVelocity(const SceneObject& object, double length_m, double time_s) {
  constexpr double kStep_s = 1e-3;
  const auto place_at = [&](double at_s) { return ComputeGroundPose(object, length_m, at_s).place_m; };
  return (place_at(time_s + kStep_s / 2) - place_at(time_s - kStep_s / 2)) / kStep_s;
}

}  // namespace victorious
