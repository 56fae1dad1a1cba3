#include "victorious/place/geolocate/flight_shift.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "victorious/geometry/geodesy.h"
#include "victorious/place/geolocate/error_ellipse.h"
#include "victorious/types/line_direction.h"

namespace victorious {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAlongLineWeight = 0.01;  // relative to that across the line
constexpr double kGroundWeight = 100;      // of the ground, relative to that of all lines
constexpr double kPathWindow_s = 2;
constexpr double kMinDistance_m = 1;

// The change of the line's direction by changes of its angles.
Vector3d Turn(const LineOfSight& line, double azimuth_rad, double elevation_rad) {
  const double sin_azimuth = std::sin(line.azimuth_rad);
  const double cos_azimuth = std::cos(line.azimuth_rad);
  const double sin_elevation = std::sin(line.elevation_rad);
  const double cos_elevation = std::cos(line.elevation_rad);
  const Vector3d side(cos_azimuth, -sin_azimuth, 0);
  const Vector3d rise(-sin_azimuth * sin_elevation, -cos_azimuth * sin_elevation, cos_elevation);
  return cos_elevation * azimuth_rad * side + elevation_rad * rise;
}

bool IsShifted(const LineOfSight& line) { return line.clock_shift || line.focal_shift; }

// The sums over the lines of sight, for one error of their flight.
struct FlightSums {
  Vector3d right = Vector3d::Zero();  // sum W s
  double count = 0;
  double time_s = 0;
  double time2_s2 = 0;
  Vector3d shift = Vector3d::Zero();       // sum s
  Vector3d shift_time = Vector3d::Zero();  // sum s t

  void Add(const Matrix3d& across, const Vector3d& by, double since_s) {
    right += across * by;
    count += 1;
    time_s += since_s;
    time2_s2 += since_s * since_s;
    shift += by;
    shift_time += since_s * by;
  }

  // The slope of s over time.
  [[nodiscard]] Vector3d Rate() const {
    const double spread_s2 = time2_s2 - time_s * time_s / count;
    return spread_s2 > 1e-6 ? Vector3d((shift_time - shift * time_s / count) / spread_s2) : Vector3d::Zero();
  }
};

}  // namespace

Vector3d ClockShiftAt(const LineOfSight& line, double distance_m) {
  if (!line.clock_shift) return Vector3d::Zero();
  const ClockShift& shift = *line.clock_shift;
  return shift.camera_enu_m + distance_m * Turn(line, shift.azimuth_rad, shift.elevation_rad);
}

Vector3d FocalShiftAt(const LineOfSight& line, double distance_m) {
  if (!line.focal_shift) return Vector3d::Zero();
  const FocalShift& shift = *line.focal_shift;
  const double farther = line.range_m ? shift.sigma : 0;
  return distance_m * (farther * DirectionOf(line) + Turn(line, shift.azimuth_rad, shift.elevation_rad));
}

void AddFlightErrors(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                     Geolocation& place) {
  const TangentPlane plane(place.point);
  FlightSums clock;
  FlightSums focal_length;
  Matrix3d normal = Matrix3d::Zero();
  double weights = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!inliers[i]) continue;
    const LineOfSight& line = lines[i];
    Vector3d object = Vector3d::Zero();
    if (place.IsMoving()) object = (line.time_s - place.time_s) * *place.velocity_enu;
    const double distance_m = std::max(kMinDistance_m, (object - plane.EnuFromGeodetic(line.camera)).norm());
    const Vector3d direction = DirectionOf(line);
    const double weight = 1 / (distance_m * distance_m);
    const Matrix3d across =
        weight * (Matrix3d::Identity() - (1 - kAlongLineWeight) * direction * direction.transpose());
    normal += across;
    weights += weight;
    const double since_s = line.time_s - lines.front().time_s;
    if (line.clock_shift) clock.Add(across, ClockShiftAt(line, distance_m), since_s);
    if (line.focal_shift) focal_length.Add(across, FocalShiftAt(line, distance_m), since_s);
  }
  if (clock.count + focal_length.count == 0) return;
  if (on_ground) normal(2, 2) += kGroundWeight * weights;
  const Eigen::LDLT<Matrix3d> solver(normal);
  for (const FlightSums* sums : {&clock, &focal_length}) {
    if (sums->count == 0) continue;
    const Vector3d shift = solver.solve(sums->right);
    const Vector3d rate = sums->Rate();
    place.covariance_enu_m2 += shift * shift.transpose();
    if (place.velocity_covariance_enu) *place.velocity_covariance_enu += rate * rate.transpose();
  }
  SetErrorRadii(place);
}

void AddFlightErrors(std::span<const LineOfSight> lines, const std::vector<bool>& inliers, bool on_ground,
                     std::span<Geolocation> path) {
  if (std::ranges::none_of(lines, IsShifted)) return;
  for (Geolocation& place : path) {
    const auto first = std::ranges::lower_bound(lines, place.time_s - kPathWindow_s, {}, &LineOfSight::time_s);
    const auto end = std::ranges::upper_bound(lines, place.time_s + kPathWindow_s, {}, &LineOfSight::time_s);
    const auto begin = first - lines.begin();
    const auto count = end - first;
    const std::vector<bool> near(inliers.begin() + begin, inliers.begin() + begin + count);
    AddFlightErrors(lines.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(count)), near, on_ground,
                    place);
  }
}

}  // namespace victorious
