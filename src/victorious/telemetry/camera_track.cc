#include "victorious/telemetry/camera_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kHoldSeconds = 0.1;  // time stamps of frames and packets seldom coincide

double Between(double a, double b, double share) { return a + share * (b - a); }

std::optional<double> Between(const std::optional<double>& a, const std::optional<double>& b, double share) {
  if (!a || !b) return std::nullopt;
  return Between(*a, *b, share);
}

// Both attitudes count as in one tangent plane: verticals 100 m apart differ by a thousandth of a degree.
std::optional<Attitude> Between(const std::optional<Attitude>& a, const std::optional<Attitude>& b, double share) {
  if (!a || !b) return std::nullopt;
  return AttitudeOf(CameraFromEnu(*a).slerp(share, CameraFromEnu(*b)));
}

GeodeticPoint Between(const GeodeticPoint& a, const GeodeticPoint& b, double share) {
  const double eastward_rad =
      WrapAngle(b.longitude_rad - a.longitude_rad);  // the shorter way, across the date line if need be
  return {Between(a.latitude_rad, b.latitude_rad, share), WrapAngle(a.longitude_rad + share * eastward_rad),
          Between(a.altitude_m, b.altitude_m, share)};
}

CameraState Between(const CameraState& a, const CameraState& b, double time_s) {
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  CameraState state = share < 0.5 ? a : b;
  state.time_s = time_s;
  state.place = Between(a.place, b.place, share);
  state.attitude = Between(a.attitude, b.attitude, share);
  state.hfov_rad = Between(a.hfov_rad, b.hfov_rad, share);
  state.sigma_position_m = Between(a.sigma_position_m, b.sigma_position_m, share);
  state.sigma_attitude_rad = Between(a.sigma_attitude_rad, b.sigma_attitude_rad, share);
  state.utc_us.reset();
  if (a.utc_us && b.utc_us) {
    state.utc_us = *a.utc_us + std::llround(share * static_cast<double>(*b.utc_us - *a.utc_us));
  }
  return state;
}

std::optional<CameraState> Held(CameraState state, double time_s) {
  if (std::abs(state.time_s - time_s) > kHoldSeconds) return std::nullopt;
  state.time_s = time_s;
  return state;
}

}  // namespace

CameraTrack::CameraTrack(std::vector<CameraState> states, double max_gap_s)
    : states_(std::move(states)), max_gap_s_(max_gap_s) {
  std::ranges::stable_sort(states_, {}, &CameraState::time_s);
  const auto repeated = std::ranges::unique(states_, {}, &CameraState::time_s);
  states_.erase(repeated.begin(), repeated.end());
}

std::optional<CameraState> CameraTrack::At(double time_s) const {
  if (states_.empty() || !std::isfinite(time_s)) return std::nullopt;
  const auto after = std::ranges::lower_bound(states_, time_s, {}, &CameraState::time_s);
  if (after == states_.end()) return Held(states_.back(), time_s);
  if (after->time_s == time_s) return *after;
  if (after == states_.begin()) return Held(*after, time_s);
  const CameraState& before = *std::prev(after);
  if (after->time_s - before.time_s > max_gap_s_ || after->datum != before.datum) return std::nullopt;
  return Between(before, *after, time_s);
}

}  // namespace victorious
