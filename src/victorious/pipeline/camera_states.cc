#include "victorious/pipeline/camera_states.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/pipeline/video_telemetry.h"

namespace victorious {

std::optional<double> GivenFieldOfView(const TelemetryOptions& options) {
  return options.hfov_deg > 0 ? std::optional(RadiansFromDegrees(options.hfov_deg)) : std::nullopt;
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
  cameras.max_gap_s_ = cameras.is_of_photos_ ? 0 : options.max_gap_s;
  cameras.trajectory_.emplace(std::move(telemetry->states), cameras.max_gap_s_);
  return cameras;
}

CameraStates CameraStates::ForLive(const VideoInfo& info, const TelemetryOptions& options) {
  const auto is_telemetry = [](const StreamInfo& stream) { return stream.type == "data" || stream.type == "subtitle"; };
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

std::optional<CameraState> CameraStates::At(double time_s) const {
  std::optional<CameraState> camera;
  if (trajectory_) camera = trajectory_->At(time_s);
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
