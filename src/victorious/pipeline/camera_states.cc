#include "victorious/pipeline/camera_states.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/pipeline/video_telemetry.h"

namespace victorious {

std::optional<double> GivenFieldOfView(const TelemetryOptions& options) {
  return options.hfov_deg.transform(RadiansFromDegrees);
}

Expected<CameraStates> CameraStates::Load(const std::string& video, const VideoInfo& info,
                                          const std::optional<std::string>& file, const TelemetryOptions& options,
                                          std::string_view consequence, const WarningSink& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::optional<Telemetry> telemetry,
                              LoadTelemetry(video, info, file, options, consequence, warn));
  if (!telemetry) return ForLive(info, options);
  CameraStates cameras;
  cameras.is_of_photos_ = telemetry->format == TelemetryFormat::kPhotos;
  for (const CameraState& state : telemetry->states) {
    if (!cameras.first_hfov_rad_) cameras.first_hfov_rad_ = state.hfov_rad;
    if (!cameras.start_utc_us_ && state.utc_us && !cameras.is_of_photos_) {
      cameras.start_utc_us_ = *state.utc_us - std::llround(state.time_s * 1e6);
    }
  }
  cameras.unknown_clock_sigma_s_ = options.clock_sigma_s;
  cameras.max_gap_s_ = cameras.is_of_photos_ ? 0 : options.max_gap_s;
  cameras.trajectory_.emplace(std::move(telemetry->states), cameras.max_gap_s_);
  return cameras;
}

CameraStates CameraStates::ForLive(const VideoInfo& info, const TelemetryOptions& options) {
  const auto is_telemetry = [](const StreamInfo& stream) {
    return stream.type == StreamType::kData || stream.type == StreamType::kSubtitle;
  };
  CameraStates cameras;
  if (info.live && std::ranges::any_of(info.streams, is_telemetry)) cameras.live_.emplace(options);
  return cameras;
}

void CameraStates::ShiftClock(double offset_s) {
  if (!trajectory_) return;
  std::vector<CameraState> states = trajectory_->states();
  for (CameraState& state : states) state.time_s += offset_s;
  trajectory_.emplace(std::move(states), max_gap_s_);
  if (start_utc_us_) *start_utc_us_ -= std::llround(offset_s * 1e6);
}

std::optional<ClockError> CameraStates::ClockErrorAt(const CameraState& now) const {
  constexpr double kHalf_s = 1;  // noise of telemetry's rows averages out over it
  constexpr double kMinMove_m = 0.01;
  constexpr double kMinTurn_rad = 1e-5;
  const CameraState before = trajectory_->At(now.time_s - kHalf_s).value_or(now);
  const CameraState after = trajectory_->At(now.time_s + kHalf_s).value_or(now);
  const double interval_s = after.time_s - before.time_s;
  if (!(interval_s > 0)) return std::nullopt;
  const double factor = clock_sigma_s_ / interval_s;
  const TangentPlane plane(now.place);
  ClockError error;
  error.moved_enu_m = factor * (plane.EnuFromGeodetic(after.place) - plane.EnuFromGeodetic(before.place));
  if (before.attitude && after.attitude) {
    const Eigen::AngleAxisd turn(CameraFromEnu(*after.attitude).conjugate() * CameraFromEnu(*before.attitude));
    error.turned_enu_rad = factor * WrapAngle(turn.angle()) * turn.axis();
  }
  if (error.moved_enu_m.norm() < kMinMove_m && error.turned_enu_rad.norm() < kMinTurn_rad) return std::nullopt;
  return error;
}

std::optional<CameraState> CameraStates::At(double time_s) const {
  std::optional<CameraState> camera;
  if (trajectory_) camera = trajectory_->At(time_s);
  if (camera && clock_sigma_s_ > 0) camera->clock_error = ClockErrorAt(*camera);
  if (live_) camera = live_->At(time_s);
  if (!fallback_hfov_rad_) return camera;
  if (!camera) camera.emplace(CameraState{.time_s = time_s});
  if (!camera->hfov_rad) camera->hfov_rad = fallback_hfov_rad_;
  return camera;
}

std::vector<std::string> CameraStates::LiveWarnings() const {
  return live_ ? live_->Warnings() : std::vector<std::string>();
}

}  // namespace victorious
