#include "victorious/place/cameras/clock_offset.h"

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr double kMinOffset_s = 0.05;
constexpr double kMinSigmas = 3;
constexpr double kMaxDuration_s = 20;
constexpr double kHover_m_s = 0.5;

double MedianSpeed(std::span<const CameraState> states) {
  std::vector<double> speeds_m_s;
  for (std::size_t i = 1; i < states.size(); ++i) {
    const double metres = TangentPlane(states[i - 1].place).EnuFromGeodetic(states[i].place).norm();
    speeds_m_s.push_back(metres / (states[i].time_s - states[i - 1].time_s));
  }
  return MedianOr(std::move(speeds_m_s), 0);
}

// Telemetry without attitudes, or beside the video's time, gives no place whatever its clock.
bool GivesPlaces(TimeOffsetStatus status) {
  switch (status) {
    case TimeOffsetStatus::kOk:
    case TimeOffsetStatus::kUncertain:
    case TimeOffsetStatus::kUnexplained:
    case TimeOffsetStatus::kPeriodic:
    case TimeOffsetStatus::kOutOfRange:
    case TimeOffsetStatus::kFewPairs:
      return true;
    case TimeOffsetStatus::kNoAttitude:
    case TimeOffsetStatus::kNoOverlap:
      break;
  }
  return false;
}

std::string DescribePrior(const ClockPrior& prior, std::span<const CameraState> states) {
  switch (prior.extent) {
    case TelemetryExtent::kOfVideo:
      return {};
    case TelemetryExtent::kDisplaced:
      return fmt::format(
          ", but it is as long as the video, and its clock is {:.2f} s {} if both begin together: {:+.2f} s are added "
          "to its times",
          std::abs(prior.offset_s), prior.offset_s < 0 ? "late" : "early", prior.offset_s);
    case TelemetryExtent::kOther:
      return fmt::format(", and it was recorded apart from the video: it covers {:.1f} to {:.1f} s of it",
                         states.front().time_s, states.back().time_s);
  }
  return {};
}

void ShiftClockBy(const TimeOffset& offset, const WarningSink& warn, CameraStates& cameras) {
  const std::optional<double> correction_s = ClockCorrection(offset);
  const ClockPrior prior = cameras.clock_prior();
  cameras.SetClockSigma(ClockSigma(offset, prior.sigma_s));
  if (!correction_s) {
    if (const auto unknown = DescribeUnknownClock(offset, cameras.trajectory()->states(), prior)) warn(*unknown);
    if (!offset.offset_s) cameras.ShiftClock(prior.offset_s);
    return;
  }
  cameras.ShiftClock(*correction_s);
  warn(
      fmt::format("telemetry: its clock is {:.2f} s {}: {:+.3f} s are added to its times, with a standard error of "
                  "{:.3f} s, estimated from the motion of the image; a given telemetry.time_offset_s is used as it is",
                  std::abs(*correction_s), *correction_s < 0 ? "late" : "early", *correction_s, offset.sigma_s));
}

}  // namespace

std::optional<double> ClockCorrection(const TimeOffset& offset) {
  if (!offset.offset_s) return std::nullopt;
  const double size_s = std::abs(*offset.offset_s);
  return size_s > kMinOffset_s && size_s > kMinSigmas * offset.sigma_s ? offset.offset_s : std::nullopt;
}

double ClockSigma(const TimeOffset& offset, double unknown_s) {
  if (!offset.offset_s) return unknown_s;
  return ClockCorrection(offset) ? offset.sigma_s : std::hypot(offset.sigma_s, *offset.offset_s);
}

std::optional<std::string> DescribeUnknownClock(const TimeOffset& offset, std::span<const CameraState> states,
                                                const ClockPrior& prior) {
  if (offset.offset_s || !GivesPlaces(offset.status) || prior.sigma_s == 0) return std::nullopt;
  const double speed_m_s = MedianSpeed(states);
  if (speed_m_s < kHover_m_s && prior.offset_s == 0) return std::nullopt;
  return fmt::format(
      "telemetry: the offset of its clock is unknown ({}){}: each second that it is off shifts all places by {:.1f} m "
      "along the flight; their errors contain {:.1f} s of it ({}), or less if the flight shows smaller errors of its "
      "telemetry; telemetry.time_offset_s corrects it",
      DescribeStatus(offset), DescribePrior(prior, states), speed_m_s, prior.sigma_s,
      prior.extent == TelemetryExtent::kOther ? "telemetry.clock_sigma_apart_s; telemetry.clock_sigma_s 0: it is exact"
                                              : "telemetry.clock_sigma_s; 0: it is exact");
}

std::optional<std::string> DescribeContradiction(const TimeOffset& offset) {
  if (!offset.contradicted) return std::nullopt;
  const auto describe = [](const Eigen::Vector3d& px_s) {
    return fmt::format("{:.0f} px/s {}, {:.0f} {} and {:.0f} px/s {}", std::abs(px_s.x()),
                       px_s.x() < 0 ? "left" : "right", std::abs(px_s.y()), px_s.y() < 0 ? "up" : "down",
                       std::abs(px_s.z()), px_s.z() < 0 ? "anticlockwise" : "clockwise");
  };
  return fmt::format(
      "telemetry: contradicts the image, as that of another flight or wrong gimbal angles do, and is not used: nothing "
      "will get a place. The image moves by {}, by the telemetry by {}; telemetry.time_offset_s, if given, keeps it",
      describe(offset.contradicted->seen_px_s), describe(offset.contradicted->predicted_px_s));
}

std::optional<std::string> DescribeFieldOfView(const FieldOfViewVerdict& verdict) {
  constexpr double kMinProbability = 0.2;  // twice that of any telemetry
  if (verdict.wrong_probability < kMinProbability) return std::nullopt;
  const auto percent = [](double log_factor) { return 100 * std::abs(std::expm1(log_factor)); };
  constexpr std::string_view kGiven = "a given --hfov is used as it is";
  if (verdict.log_factor == 0) {
    return fmt::format(
        "telemetry: its field of view may be wrong, by the motion of the image, or the ground slopes: the errors of "
        "places contain {:.0f} % of the distance; {}",
        percent(verdict.sigma), kGiven);
  }
  return fmt::format(
      "telemetry: its field of view is {:.0f} % too {}, by the motion of the image, or else the ground slopes: it is "
      "corrected, with a standard error of {:.0f} %; {}",
      percent(verdict.log_factor), verdict.log_factor > 0 ? "wide" : "narrow", percent(verdict.sigma), kGiven);
}

std::string DescribeYaw(const YawMeasurement& wrong) {
  return fmt::format(
      "telemetry: its yaw is {:.1f} degrees too {}, by the direction in which the ground moves through the image: it "
      "is corrected, with a standard error of {:.1f} degrees",
      std::abs(DegreesFromRadians(wrong.error_rad)), wrong.error_rad > 0 ? "large" : "small",
      DegreesFromRadians(wrong.sigma_rad));
}

GivenOfCamera FindGiven(const TelemetryOptions& options) {
  return {.field_of_view = options.hfov_deg.has_value(), .yaw = options.camera_yaw_deg.has_value()};
}

namespace {

void CorrectCamera(const std::optional<CameraErrors>& errors, const GivenOfCamera& given, const WarningSink& warn,
                   CameraStates& cameras) {
  if (!given.field_of_view) {
    const FieldOfViewVerdict verdict = JudgeFieldOfView(FocalOf(errors));
    if (const auto wrong = DescribeFieldOfView(verdict)) warn(*wrong);
    cameras.CorrectFocalLength(verdict.log_factor, verdict.sigma);
  }
  if (given.yaw || !errors || !errors->yaw) return;
  const std::optional<double> error_rad = SignificantYawError(*errors->yaw);
  if (!error_rad) return;
  warn(DescribeYaw(*errors->yaw));
  cameras.CorrectYaw(*error_rad);
}

// A field of view that is wrong by a factor of two and more looks as if telemetry were another flight's. False if it is
// not the cause.
bool ReconcileFieldOfView(const ImageMotions& motions, const TimeOffsetOptions& options, const GivenOfCamera& given,
                          const WarningSink& warn, CameraStates& cameras) {
  const std::optional<CameraErrors> errors = MeasureCameraErrors(motions, *cameras.trajectory());
  const FieldOfViewVerdict verdict = JudgeFieldOfView(FocalOf(errors));
  if (verdict.log_factor == 0) return false;
  CameraStates corrected = cameras;
  corrected.CorrectFocalLength(verdict.log_factor, verdict.sigma);
  const TimeOffset offset = EstimateTimeOffset(motions, *corrected.trajectory(), options);
  if (offset.contradicted) return false;
  CorrectCamera(errors, given, warn, cameras);
  ShiftClockBy(offset, warn, cameras);
  cameras.SetGroundHeight(EstimateGroundHeight(motions, *cameras.trajectory()));
  return true;
}

}  // namespace

Status CorrectTelemetry(const std::string& video, double impulse_fraction, const GivenOfCamera& given,
                        const CancelToken& cancel, const WarningSink& warn, CameraStates& cameras) {
  if (!cameras.HasStates() || cameras.is_of_photos()) return {};
  const TimeOffsetOptions options{.max_duration_s = kMaxDuration_s};
  const Expected<ImageMotions> motions = MeasureMotions(video, options, impulse_fraction, cancel);
  if (!motions) {
    if (motions.error().code == ErrorCode::kCancelled) return std::unexpected(motions.error());
    cameras.SetClockSigma(cameras.clock_prior().sigma_s);
    cameras.ShiftClock(cameras.clock_prior().offset_s);
    warn("telemetry: the offset of its clock is unknown: " + motions.error().message);
    return {};
  }
  const TimeOffset offset = EstimateTimeOffset(*motions, *cameras.trajectory(), options);
  if (const auto contradiction = DescribeContradiction(offset)) {
    if (!given.field_of_view && ReconcileFieldOfView(*motions, options, given, warn, cameras)) return {};
    cameras.Forget();
    warn(*contradiction);
    return {};
  }
  ShiftClockBy(offset, warn, cameras);
  CorrectCamera(MeasureCameraErrors(*motions, *cameras.trajectory()), given, warn, cameras);
  cameras.SetGroundHeight(EstimateGroundHeight(*motions, *cameras.trajectory()));
  return {};
}

}  // namespace victorious
