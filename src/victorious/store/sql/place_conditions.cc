#include "victorious/store/sql/place_conditions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace victorious::sql {
namespace {

constexpr double kSmallestRadius_m = 6'335'000;  // of curvature of the ellipsoid: at the equator, along the meridian

// The objects between two latitudes.
Conditions BetweenLatitudes(double south_rad, double north_rad, PlacedObjects objects) {
  Conditions placed;
  if (objects == PlacedObjects::kListed) placed.Add("is_listed = 1");
  placed.Add("latitude_rad BETWEEN ? AND ?", south_rad, north_rad);
  return placed;
}

void AddPlaced(Dialect dialect, const Conditions& placed, PlacedObjects objects, Conditions& conditions) {
  const std::string index = objects == PlacedObjects::kListed ? IndexedBy(dialect, "objects_by_place") : "";
  conditions.AddQuery(fmt::format("o.id IN (SELECT id FROM objects{} {{}})", index), placed);
}

// A region of `place` that contains a circle, as a condition; empty if it crosses the antimeridian or holds a pole.
std::string EnvelopeOf(const GeoCircle& circle) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double angle = 1.01 * circle.radius_m / kSmallestRadius_m;
  const double south = circle.centre.latitude_rad - angle;
  const double north = circle.centre.latitude_rad + angle;
  constexpr double kNearPole = 1.55;
  if (south < -kNearPole || north > kNearPole) return {};
  const double width = angle / std::cos(std::max(std::abs(south), std::abs(north)));
  const double west = circle.centre.longitude_rad - width;
  const double east = circle.centre.longitude_rad + width;
  if (west < -std::numbers::pi || east > std::numbers::pi) return {};
  return fmt::format("place && ST_MakeEnvelope({}, {}, {}, {}, 4979)", kDegrees * west, kDegrees * south,
                     kDegrees * east, kDegrees * north);
}

// The distance in geocentric coordinates, WGS 84, of the point at the centre's height.
void AddDistanceTest(const GeoCircle& circle, Conditions& placed) {
  constexpr double kFlattening = 1 / 298.257223563;
  constexpr double kSquaredEccentricity = kFlattening * (2 - kFlattening);
  const Eigen::Vector3d centre = EarthCenteredFromGeodetic(circle.centre);
  const double height = circle.centre.altitude_m;
  const std::string normal =
      fmt::format("6378137 / sqrt(1 - {} * sin(latitude_rad) * sin(latitude_rad))", kSquaredEccentricity);
  placed.Add(fmt::format("power(({0} + ?) * cos(latitude_rad) * cos(longitude_rad) - ?, 2) + "
                         "power(({0} + ?) * cos(latitude_rad) * sin(longitude_rad) - ?, 2) + "
                         "power(({1} * {0} + ?) * sin(latitude_rad) - ?, 2) <= ?",
                         normal, 1 - kSquaredEccentricity),
             height, centre.x(), height, centre.y(), height, centre.z(), circle.radius_m * circle.radius_m);
}

std::string ArrayText(const std::vector<double>& numbers) { return fmt::format("{{{}}}", fmt::join(numbers, ",")); }

void AddEdgesTest(const GeoPolygon& area, Conditions& placed) {
  const double origin = area.corners.front().longitude_rad;
  std::vector<double> y1, x1, y2, x2;
  const GeodeticPoint* before = &area.corners.back();
  for (const GeodeticPoint& corner : area.corners) {
    y1.push_back(before->latitude_rad);
    x1.push_back(std::remainder(before->longitude_rad - origin, 2 * std::numbers::pi));
    y2.push_back(corner.latitude_rad);
    x2.push_back(std::remainder(corner.longitude_rad - origin, 2 * std::numbers::pi));
    before = &corner;
  }
  placed.Add(
      "(SELECT count(*) FROM unnest(?::float8[], ?::float8[], ?::float8[], ?::float8[]) AS edge (y1, x1, y2, x2) "
      "WHERE (edge.y1 > latitude_rad) <> (edge.y2 > latitude_rad) AND "
      "longitude_rad - ? - 2 * pi() * round((longitude_rad - ?) / (2 * pi())) < "
      "edge.x1 + (latitude_rad - edge.y1) / nullif(edge.y2 - edge.y1, 0) * (edge.x2 - edge.x1)) % 2 = 1",
      ArrayText(y1), ArrayText(x1), ArrayText(y2), ArrayText(x2), origin, origin);
}

}  // namespace

void AddNear(Dialect dialect, const GeoCircle& circle, PlacedObjects objects, Conditions& conditions) {
  const double angle = 1.01 * circle.radius_m / kSmallestRadius_m;
  const double latitude = circle.centre.latitude_rad;
  Conditions placed = BetweenLatitudes(latitude - angle, latitude + angle, objects);
  if (dialect == Dialect::kSqlite) {
    placed.Add("is_within(latitude_rad, longitude_rad, ?, ?, ?, ?)", circle.centre.latitude_rad,
               circle.centre.longitude_rad, circle.centre.altitude_m, circle.radius_m);
  } else {
    if (const std::string envelope = EnvelopeOf(circle); !envelope.empty()) placed.Add(envelope);
    AddDistanceTest(circle, placed);
  }
  AddPlaced(dialect, placed, objects, conditions);
}

void AddInside(Dialect dialect, const GeoPolygon& area, PlacedObjects objects, Conditions& conditions) {
  const auto [south, north] = std::ranges::minmax(area.corners, {}, &GeodeticPoint::latitude_rad);
  Conditions placed = BetweenLatitudes(south.latitude_rad, north.latitude_rad, objects);
  if (dialect == Dialect::kSqlite) {
    std::vector<double> corners;
    for (const GeodeticPoint& corner : area.corners) {
      corners.push_back(corner.latitude_rad);
      corners.push_back(corner.longitude_rad);
    }
    placed.Add("is_inside(latitude_rad, longitude_rad, ?)", fmt::format("{}", fmt::join(corners, ",")));
  } else {
    AddEdgesTest(area, placed);
  }
  AddPlaced(dialect, placed, objects, conditions);
}

}  // namespace victorious::sql
