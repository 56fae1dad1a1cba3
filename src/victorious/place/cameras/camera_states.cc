#include "victorious/place/cameras/camera_states.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious {

namespace {

// Half the interval of the motion for the clock's error: noise of telemetry's rows averages out over it.
constexpr double kClockHalf_s = 1;
// Frames without a measured motion, between which the camera turns steadily.
constexpr double kMaxAssumedGap_s = 2;
constexpr std::size_t kMinStateBytes = 4 * sizeof(double) + sizeof(VerticalDatum);

void PackState(const CameraState& state, ByteWriter& writer) {
  for (const double value :
       {state.time_s, state.place.latitude_rad, state.place.longitude_rad, state.place.altitude_m}) {
    writer.Put(value);
  }
  writer.Put(state.datum);
  if (writer.PutHas(state.attitude)) {
    for (const double value : {state.attitude->yaw_rad, state.attitude->pitch_rad, state.attitude->roll_rad})
      writer.Put(value);
  }
  for (const auto& value : {state.hfov_rad, state.sigma_position_m, state.sigma_attitude_rad})
    writer.PutOptional(value);
  writer.PutOptional(state.utc_us);
  if (writer.PutHas(state.clock_error)) {
    for (const double value : state.clock_error->moved_enu_m) writer.Put(value);
    for (const double value : state.clock_error->turned_enu_rad) writer.Put(value);
  }
  if (writer.PutHas(state.distortion)) {
    for (const double value : *state.distortion) writer.Put(value);
  }
}

CameraState UnpackState(ByteReader& reader) {
  CameraState state;
  for (double* value :
       {&state.time_s, &state.place.latitude_rad, &state.place.longitude_rad, &state.place.altitude_m}) {
    *value = reader.Get<double>();
  }
  state.datum = reader.GetEnum(VerticalDatum::kUnknown);
  if (reader.Get<bool>()) {
    Attitude& attitude = state.attitude.emplace();
    for (double* value : {&attitude.yaw_rad, &attitude.pitch_rad, &attitude.roll_rad}) *value = reader.Get<double>();
  }
  for (auto* value : {&state.hfov_rad, &state.sigma_position_m, &state.sigma_attitude_rad})
    *value = reader.GetOptional<double>();
  state.utc_us = reader.GetOptional<std::int64_t>();
  if (reader.Get<bool>()) {
    ClockError& error = state.clock_error.emplace();
    for (double& value : error.moved_enu_m) value = reader.Get<double>();
    for (double& value : error.turned_enu_rad) value = reader.Get<double>();
  }
  if (reader.Get<bool>()) {
    for (double& value : state.distortion.emplace()) value = reader.Get<double>();
  }
  return state;
}

}  // namespace

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
  cameras.clock_prior_ = MakeClockPrior(telemetry->states, info.duration_s, options);
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

void CameraStates::CorrectFocalLength(double log_factor, double sigma) {
  focal_sigma_ = sigma;
  if (!trajectory_ || log_factor == 0) return;
  const double factor = std::exp(-log_factor);
  const auto corrected = [&](double hfov_rad) { return 2 * std::atan(factor * std::tan(hfov_rad / 2)); };
  std::vector<CameraState> states = trajectory_->states();
  for (CameraState& state : states) state.hfov_rad = state.hfov_rad.transform(corrected);
  trajectory_.emplace(std::move(states), max_gap_s_);
  first_hfov_rad_ = first_hfov_rad_.transform(corrected);
}

void CameraStates::CorrectYaw(double error_rad) {
  if (!trajectory_) return;
  std::vector<CameraState> states = trajectory_->states();
  for (CameraState& state : states) {
    if (state.attitude) state.attitude->yaw_rad = WrapAngle(state.attitude->yaw_rad - error_rad);
  }
  trajectory_.emplace(std::move(states), max_gap_s_);
}

std::optional<double> CameraStates::HeightAboveGround(const std::optional<CameraState>& camera,
                                                      const Ground* given) const {
  if (!camera || !camera->attitude) return std::nullopt;
  std::optional<double> ground_m;
  if (given == nullptr) {
    if (ground_height_ && ground_height_->datum == camera->datum) ground_m = ground_height_->height_m;
  } else if (camera->datum == VerticalDatum::kEllipsoid) {
    const TangentPlane plane(camera->place);
    const Eigen::Vector3d along = CameraFromEnu(*camera->attitude).conjugate() * Eigen::Vector3d::UnitZ();
    const auto patch = IntersectGround(*given, plane, Eigen::Vector3d::Zero(), along, 0);
    ground_m = patch ? std::optional(plane.GeodeticFromEnu(patch->point).altitude_m) : given->HeightAt(camera->place);
  }
  if (!ground_m || !(camera->place.altitude_m > *ground_m)) return std::nullopt;
  return camera->place.altitude_m - *ground_m;
}

void CameraStates::Forget() {
  ground_height_.reset();
  is_forgotten_ = true;
  trajectory_.reset();
  first_hfov_rad_.reset();
  start_utc_us_.reset();
}

CameraStates CameraStates::Between(double from_s, double to_s) const {
  CameraStates part = *this;
  if (!trajectory_) return part;
  const std::vector<CameraState>& states = trajectory_->states();
  // With a state on both sides, between which At() interpolates.
  auto begin = std::ranges::lower_bound(states, from_s - kClockHalf_s, {}, &CameraState::time_s);
  if (begin != states.begin()) --begin;
  auto end = std::ranges::upper_bound(states, to_s + kClockHalf_s, {}, &CameraState::time_s);
  if (end != states.end()) ++end;
  part.trajectory_.emplace(std::vector<CameraState>(begin, end), max_gap_s_);
  return part;
}

std::optional<ClockError> CameraStates::ClockErrorAt(const CameraState& now) const {
  constexpr double kMinMove_m = 0.01;
  constexpr double kMinTurn_rad = 1e-5;
  const CameraState before = trajectory_->At(now.time_s - kClockHalf_s).value_or(now);
  const CameraState after = trajectory_->At(now.time_s + kClockHalf_s).value_or(now);
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
  if (camera && camera->hfov_rad && focal_sigma_ > 0) camera->sigma_focal = focal_sigma_;
  if (live_) camera = live_->At(time_s);
  if (!fallback_hfov_rad_) return camera;
  if (!camera) camera.emplace(CameraState{.time_s = time_s});
  if (!camera->hfov_rad) camera->hfov_rad = fallback_hfov_rad_;
  return camera;
}

void CameraStates::SetAssumedAttitudes(std::vector<CameraState> states) {
  assumed_.reset();
  if (!states.empty()) assumed_.emplace(std::move(states), kMaxAssumedGap_s);
}

std::optional<CameraState> CameraStates::ForSearch(double time_s) const {
  std::optional<CameraState> camera = At(time_s);
  if (!assumed_ || (camera && camera->attitude)) return camera;
  return assumed_->At(time_s);
}

void CameraStates::Pack(ByteWriter& writer) const {
  for (const auto* trajectory : {&trajectory_, &assumed_}) {
    if (!writer.PutHas(*trajectory)) continue;
    writer.Put(std::uint64_t{(*trajectory)->states().size()});
    for (const CameraState& state : (*trajectory)->states()) PackState(state, writer);
  }
  writer.Put(is_of_photos_);
  writer.Put(clock_prior_.extent);
  for (const double value : {clock_prior_.offset_s, clock_prior_.sigma_s, max_gap_s_, clock_sigma_s_, focal_sigma_})
    writer.Put(value);
  if (writer.PutHas(ground_height_)) {
    for (const double value : {ground_height_->height_m, ground_height_->sigma_m}) writer.Put(value);
    writer.Put(ground_height_->datum);
  }
  writer.PutOptional(fallback_hfov_rad_);
  writer.PutOptional(first_hfov_rad_);
  writer.PutOptional(start_utc_us_);
}

CameraStates CameraStates::Unpack(ByteReader& reader) {
  CameraStates cameras;
  std::optional<std::vector<CameraState>> states;
  std::optional<std::vector<CameraState>> assumed;
  for (auto* trajectory : {&states, &assumed}) {
    if (!reader.Get<bool>()) continue;
    trajectory->emplace(reader.GetCount(kMinStateBytes));
    for (CameraState& state : **trajectory) state = UnpackState(reader);
  }
  cameras.is_of_photos_ = reader.Get<bool>();
  cameras.clock_prior_.extent = reader.GetEnum(TelemetryExtent::kOther);
  for (double* value : {&cameras.clock_prior_.offset_s, &cameras.clock_prior_.sigma_s, &cameras.max_gap_s_,
                        &cameras.clock_sigma_s_, &cameras.focal_sigma_})
    *value = reader.Get<double>();
  if (reader.Get<bool>()) {
    GroundHeight& ground = cameras.ground_height_.emplace();
    for (double* value : {&ground.height_m, &ground.sigma_m}) *value = reader.Get<double>();
    ground.datum = reader.GetEnum(VerticalDatum::kUnknown);
  }
  cameras.fallback_hfov_rad_ = reader.GetOptional<double>();
  cameras.first_hfov_rad_ = reader.GetOptional<double>();
  cameras.start_utc_us_ = reader.GetOptional<std::int64_t>();
  if (states && !reader.HasFailed()) cameras.trajectory_.emplace(*std::move(states), cameras.max_gap_s_);
  if (assumed && !reader.HasFailed()) cameras.SetAssumedAttitudes(*std::move(assumed));
  return cameras;
}

std::vector<std::string> CameraStates::LiveWarnings() const {
  return live_ ? live_->Warnings() : std::vector<std::string>();
}

}  // namespace victorious
