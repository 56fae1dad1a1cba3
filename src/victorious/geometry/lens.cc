#include "victorious/geometry/lens.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

double RadialFactor(double r2, const LensDistortion& lens) {
  return 1 + r2 * (lens[0] + r2 * (lens[1] + r2 * lens[4]));
}

Vector2d Tangential(const Vector2d& point, const LensDistortion& lens) {
  const double r2 = point.squaredNorm();
  const double xy = point.x() * point.y();
  return {2 * lens[2] * xy + lens[3] * (r2 + 2 * point.x() * point.x()),
          lens[2] * (r2 + 2 * point.y() * point.y()) + 2 * lens[3] * xy};
}

}  // namespace

Vector2d Distort(const Vector2d& point, const LensDistortion& lens) {
  return RadialFactor(point.squaredNorm(), lens) * point + Tangential(point, lens);
}

Vector2d Undistort(const Vector2d& distorted, const LensDistortion& lens) {
  constexpr int kMaxRounds = 50;
  constexpr double kTolerance = 1e-12;
  Vector2d point = distorted;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Vector2d next = (distorted - Tangential(point, lens)) / RadialFactor(point.squaredNorm(), lens);
    if (!next.allFinite()) return distorted;
    const double moved = (next - point).norm();
    point = next;
    if (moved < kTolerance) break;
  }
  return point;
}

}  // namespace victorious
