#include "victorious/input/telemetry/given_attitude.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kGivenSigma_rad = RadiansFromDegrees(2);
constexpr double kCourseSigma_rad = RadiansFromDegrees(10);

// The course is taken over a way this long, several times the error of a GPS receiver from fix to fix.
constexpr double kMinWay_m = 2;

// The courses of states in order. Amortised O(1) each.
class Courses {
 public:
  explicit Courses(const std::vector<CameraState>& states) : states_(states) {}

  /// Direction from state i to a later one that is kMinWay_m away, clockwise from north; std::nullopt if there is none.
  /// That is the next such state, or a later one where the camera hovered before i.
  /// @param i  not before that of the last call
  std::optional<double> From(std::size_t i) {
    const TangentPlane plane(states_[i].place);
    for (target_ = std::max(target_, i + 1); target_ < states_.size(); ++target_) {
      const Eigen::Vector3d way = plane.EnuFromGeodetic(states_[target_].place);
      if (way.head<2>().norm() >= kMinWay_m) return std::atan2(way.x(), way.y());
    }
    return std::nullopt;
  }

 private:
  const std::vector<CameraState>& states_;
  std::size_t target_ = 0;  // whatever is before it is near the state of the last call
};

}  // namespace

void CompleteAttitudes(std::vector<CameraState>& states, const TelemetryOptions& options,
                       std::vector<std::string>& warnings) {
  if (!options.camera_pitch_deg) return;
  std::optional<double> yaw_rad;
  if (options.camera_yaw_deg) yaw_rad = RadiansFromDegrees(*options.camera_yaw_deg);
  bool incomplete = false;
  Courses courses(states);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].attitude) continue;
    if (!options.camera_yaw_deg) {
      if (const auto course_rad = courses.From(i)) yaw_rad = course_rad;  // near the end: the last course
    }
    if (!yaw_rad) {
      incomplete = true;
      continue;
    }
    states[i].attitude = Attitude{*yaw_rad, RadiansFromDegrees(*options.camera_pitch_deg), 0};
    states[i].sigma_attitude_rad = options.camera_yaw_deg ? kGivenSigma_rad : kCourseSigma_rad;
  }
  if (incomplete) warnings.emplace_back("the camera does not move, so its course gives no yaw: give --yaw");
}

}  // namespace victorious
