#include "victorious/geometry/ground.h"

#include <algorithm>
#include <cmath>

namespace victorious {
namespace {

using Eigen::Vector3d;

constexpr double kMaxRangeM = 2e5;          // maximum range of a ray
constexpr double kMaxGroundHeightM = 9000;  // altitude above all ground
constexpr double kToleranceM = 1e-3;
constexpr double kMinDescent = 0.01;  // minimum sine of the incidence angle, about half a degree

// A ray above the ground, parametrised by distance.
class GroundRay {
 public:
  GroundRay(const Ground& ground, const TangentPlane& plane, const Vector3d& from, const Vector3d& along)
      : ground_(ground), plane_(plane), from_(from), along_(along) {}

  [[nodiscard]] Vector3d PointAt(double distance_m) const { return from_ + distance_m * along_; }

  // Height of the ray above the ground, m; std::nullopt where the ground is not known.
  [[nodiscard]] std::optional<double> ClearanceAt(double distance_m) const {
    const GeodeticPoint point = plane_.GeodeticFromEnu(PointAt(distance_m));
    const auto height_m = ground_.HeightAt(point);
    if (!height_m) return std::nullopt;
    return point.altitude_m - *height_m;
  }

  // Height lost per metre along the ray, at most 1; negative where it rises.
  [[nodiscard]] double DescentAt(double distance_m) const {
    return -(plane_.LocalEnuFromEnu(PointAt(distance_m)) * along_).z();
  }

  // A step that cannot pass through the ground; over unknown ground, 1 % of the distance so far.
  [[nodiscard]] double StepAt(double distance_m, const std::optional<double>& clearance_m) const {
    constexpr double kUnknownFraction = 0.01;
    const double descent_rate = DescentAt(distance_m);
    const double level = std::sqrt(std::max(0.0, 1 - descent_rate * descent_rate));
    const double min_step_m = ground_.Spacing() / 2 / std::max(level, kMinDescent);
    if (!clearance_m) return std::max(min_step_m, kUnknownFraction * distance_m);
    const double closing_rate =
        ground_.MaxSlope() * level + descent_rate;  // maximum loss of clearance per metre along the ray
    return closing_rate > 0 ? std::max(min_step_m, *clearance_m / closing_rate) : kMaxRangeM;
  }

  [[nodiscard]] bool IsAboveAllGround(double distance_m) const {
    return plane_.GeodeticFromEnu(PointAt(distance_m)).altitude_m > kMaxGroundHeightM && DescentAt(distance_m) <= 0;
  }

  // Bisects between a point above the ground and one on or below it.
  [[nodiscard]] std::optional<double> FindCrossing(double above_m, double below_m) const {
    while (below_m - above_m > kToleranceM) {
      const double middle_m = (above_m + below_m) / 2;
      const auto clearance_m = ClearanceAt(middle_m);
      if (!clearance_m) return std::nullopt;
      (*clearance_m > 0 ? above_m : below_m) = middle_m;
    }
    return below_m;
  }

 private:
  const Ground& ground_;
  const TangentPlane& plane_;
  Vector3d from_;
  Vector3d along_;
};

}  // namespace

std::optional<GroundPatch> GroundPatchAt(const Ground& ground, const TangentPlane& plane,
                                         const Vector3d& point_in_plane) {
  GeodeticPoint below = plane.GeodeticFromEnu(point_in_plane);
  const auto height_m = ground.HeightAt(below);
  if (!height_m) return std::nullopt;
  below.altitude_m = *height_m;
  const TangentPlane local(below);
  const auto height_at = [&](double east_m, double north_m) {
    return ground.HeightAt(local.GeodeticFromEnu({east_m, north_m, 0})).value_or(*height_m);
  };
  const double half_m = ground.Spacing() / 2;
  const Vector3d normal(height_at(-half_m, 0) - height_at(half_m, 0), height_at(0, -half_m) - height_at(0, half_m),
                        2 * half_m);
  const Vector3d point = plane.EnuFromGeodetic(below);
  return GroundPatch{point, plane.LocalEnuFromEnu(point).conjugate() * normal.normalized()};
}

double VerticalPart(const GroundPatch& patch, const TangentPlane& plane) {
  return (plane.LocalEnuFromEnu(patch.point) * patch.normal).z();
}

std::expected<GroundPatch, GroundMiss> IntersectGround(const Ground& ground, const TangentPlane& plane,
                                                       const Vector3d& from, const Vector3d& along, double slack_m) {
  const GroundRay ray(ground, plane, from, along);
  std::optional<double> above_m;  // the last point known to be above the ground, unless the ground became unknown since
  bool is_emerging = false;       // the ray started slightly below the ground
  bool known = false;
  double distance_m = 0;
  while (distance_m < kMaxRangeM) {
    const auto clearance_m = ray.ClearanceAt(distance_m);
    known = clearance_m.has_value();
    if (!clearance_m) {
      above_m.reset();
    } else if (*clearance_m > kToleranceM) {
      above_m = distance_m;
      is_emerging = false;
    } else if (above_m) {
      const auto crossing_m = ray.FindCrossing(*above_m, distance_m);
      const auto patch = crossing_m ? GroundPatchAt(ground, plane, ray.PointAt(*crossing_m)) : std::nullopt;
      if (!patch) return std::unexpected(GroundMiss::kUnknown);
      if (-along.dot(patch->normal) < kMinDescent) return std::unexpected(GroundMiss::kAbove);
      return *patch;
    } else if (distance_m == 0 || is_emerging) {
      if (*clearance_m < -slack_m) return std::unexpected(GroundMiss::kBelow);
      is_emerging = true;
    } else {
      return std::unexpected(GroundMiss::kUnknown);  // the ray went below the ground where it is not known
    }
    if (ray.IsAboveAllGround(distance_m)) break;
    distance_m += ray.StepAt(distance_m, above_m ? clearance_m : std::nullopt);
  }
  if (is_emerging) return std::unexpected(GroundMiss::kBelow);
  return std::unexpected(known ? GroundMiss::kAbove : GroundMiss::kUnknown);
}

}  // namespace victorious
