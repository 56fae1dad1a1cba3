#include "victorious/place/calibrate/assumed_attitude.h"

#include <cmath>
#include <cstddef>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Of lenses for search: objects off the axis are seen from other azimuths by some degrees more or less.
constexpr double kHfov_rad = RadiansFromDegrees(30);
constexpr double kMaxUnknown = 0.1;

}  // namespace

std::vector<CameraState> AssumeAttitudes(const ImageMotions& seen, double off_nadir_rad) {
  if (seen.motions.empty()) return {};
  std::vector<CameraState> states;
  double yaw_rad = 0;
  double known_s = 0;
  const auto add = [&](double time_s) {
    states.push_back({.time_s = time_s,
                      .attitude = Attitude{.yaw_rad = yaw_rad, .pitch_rad = off_nadir_rad - kPi / 2},
                      .hfov_rad = kHfov_rad});
  };
  add(seen.motions.front().from_s);
  for (const ImageMotion& motion : seen.motions) {
    if (!motion.flow) continue;
    yaw_rad = WrapAngle(yaw_rad - motion.flow->gradient(1, 0) / std::cos(off_nadir_rad));
    known_s += motion.to_s - motion.from_s;
    add(motion.to_s);
  }
  const double length_s = seen.motions.back().to_s - seen.motions.front().from_s;
  return known_s < (1 - kMaxUnknown) * length_s ? std::vector<CameraState>() : states;
}

}  // namespace victorious
