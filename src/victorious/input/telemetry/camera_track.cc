#include "victorious/input/telemetry/camera_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kMaxHold_s = 0.1;  // time stamps of frames and packets seldom coincide

double Interpolate(double a, double b, double fraction) { return a + fraction * (b - a); }

std::optional<double> Interpolate(const std::optional<double>& a, const std::optional<double>& b, double fraction) {
  if (!a || !b) return std::nullopt;
  return Interpolate(*a, *b, fraction);
}

// Both attitudes count as in one tangent plane: verticals 100 m apart differ by a thousandth of a degree.
std::optional<Attitude> Interpolate(const std::optional<Attitude>& a, const std::optional<Attitude>& b,
                                    double fraction) {
  if (!a || !b) return std::nullopt;
  return AttitudeFromRotation(CameraFromEnu(*a).slerp(fraction, CameraFromEnu(*b)));
}

GeodeticPoint Interpolate(const GeodeticPoint& a, const GeodeticPoint& b, double fraction) {
  const double eastward_rad =
      WrapAngle(b.longitude_rad - a.longitude_rad);  // the shorter way, across the date line if need be
  return {Interpolate(a.latitude_rad, b.latitude_rad, fraction), WrapAngle(a.longitude_rad + fraction * eastward_rad),
          Interpolate(a.altitude_m, b.altitude_m, fraction)};
}

CameraState Interpolate(const CameraState& a, const CameraState& b, double time_s) {
  const double fraction = (time_s - a.time_s) / (b.time_s - a.time_s);
  CameraState state = fraction < 0.5 ? a : b;
  state.time_s = time_s;
  state.place = Interpolate(a.place, b.place, fraction);
  state.attitude = Interpolate(a.attitude, b.attitude, fraction);
  state.hfov_rad = Interpolate(a.hfov_rad, b.hfov_rad, fraction);
  state.sigma_position_m = Interpolate(a.sigma_position_m, b.sigma_position_m, fraction);
  state.sigma_attitude_rad = Interpolate(a.sigma_attitude_rad, b.sigma_attitude_rad, fraction);
  state.utc_us.reset();
  if (a.utc_us && b.utc_us) {
    state.utc_us = *a.utc_us + std::llround(fraction * static_cast<double>(*b.utc_us - *a.utc_us));
  }
  return state;
}

std::optional<CameraState> HoldNearest(CameraState state, double time_s, double max_gap_s) {
  if (std::abs(state.time_s - time_s) > std::min(kMaxHold_s, max_gap_s)) return std::nullopt;
  state.time_s = time_s;
  return state;
}

}  // namespace

CameraTrajectory::CameraTrajectory(std::vector<CameraState> states, double max_gap_s)
    : states_(std::move(states)), max_gap_s_(max_gap_s) {
  std::ranges::stable_sort(states_, {}, &CameraState::time_s);
  const auto repeated = std::ranges::unique(states_, {}, &CameraState::time_s);
  states_.erase(repeated.begin(), repeated.end());
}

std::optional<CameraState> CameraTrajectory::At(double time_s) const {
  if (states_.empty() || !std::isfinite(time_s)) return std::nullopt;
  const auto after = std::ranges::lower_bound(states_, time_s, {}, &CameraState::time_s);
  if (after == states_.end()) return HoldNearest(states_.back(), time_s, max_gap_s_);
  if (after->time_s == time_s) return *after;
  if (after == states_.begin()) return HoldNearest(*after, time_s, max_gap_s_);
  const CameraState& before = *std::prev(after);
  if (after->time_s - before.time_s > max_gap_s_ || after->datum != before.datum) return std::nullopt;
  return Interpolate(before, *after, time_s);
}

}  // namespace victorious
