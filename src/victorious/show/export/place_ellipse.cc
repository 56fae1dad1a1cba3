#include "victorious/show/export/place_ellipse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// The border of the horizontal 90 % confidence ellipse of a normal distribution, counter-clockwise and closed.
GeodeticRing BorderOf(const Geolocation& place) {
  constexpr int kCorners = 48;
  constexpr double kRadius = 2.145966026289347;  // sqrt(-2 ln 0.1), in standard deviations: 90 % of a 2D normal
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(place.covariance_enu_m2.topLeftCorner<2, 2>());
  Eigen::Matrix2d directions = axes.eigenvectors();
  if (directions.determinant() < 0) directions.col(1) *= -1;
  const Eigen::Vector2d lengths = kRadius * axes.eigenvalues().cwiseMax(0).cwiseSqrt();
  const TangentPlane plane(place.point);
  GeodeticRing border;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle = 2 * kPi * (i % kCorners) / kCorners;
    const Eigen::Vector2d corner = directions * lengths.cwiseProduct(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    border.push_back(plane.GeodeticFromEnu({corner.x(), corner.y(), 0}));
  }
  return border;
}

// Clips a closed ring to the part east (`east`) or west of a meridian. Returns a closed ring.
GeodeticRing Beside(const GeodeticRing& ring, double longitude_rad, bool east) {
  const auto inside = [&](const GeodeticPoint& point) {
    return east ? point.longitude_rad >= longitude_rad : point.longitude_rad <= longitude_rad;
  };
  GeodeticRing part;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    const GeodeticPoint& a = ring[i];
    const GeodeticPoint& b = ring[i + 1];
    if (inside(a)) part.push_back(a);
    if (inside(a) == inside(b)) continue;
    const double fraction = (longitude_rad - a.longitude_rad) / (b.longitude_rad - a.longitude_rad);
    part.push_back({a.latitude_rad + fraction * (b.latitude_rad - a.latitude_rad), longitude_rad, a.altitude_m});
  }
  if (!part.empty()) part.push_back(part.front());
  return part;
}

// A ring around a place, cut at the antimeridian if it crosses it (RFC 7946, section 3.1.9).
std::vector<GeodeticRing> CutAtAntimeridian(GeodeticRing ring, double middle_longitude_rad) {
  for (GeodeticPoint& point : ring) {
    point.longitude_rad = middle_longitude_rad + WrapAngle(point.longitude_rad - middle_longitude_rad);
  }
  for (const double edge_rad : {-kPi, kPi}) {
    const auto [west, east] = std::ranges::minmax(ring, {}, &GeodeticPoint::longitude_rad);
    if (!(west.longitude_rad < edge_rad && edge_rad < east.longitude_rad)) continue;
    std::vector<GeodeticRing> parts = {Beside(ring, edge_rad, false), Beside(ring, edge_rad, true)};
    GeodeticRing& beyond = edge_rad < 0 ? parts.front() : parts.back();
    for (GeodeticPoint& point : beyond) point.longitude_rad -= 2 * edge_rad;
    return parts;
  }
  return {std::move(ring)};
}

}  // namespace

std::vector<GeodeticRing> ComputeEllipse(const Geolocation& place) {
  return CutAtAntimeridian(BorderOf(place), place.point.longitude_rad);
}

}  // namespace victorious
