#include "victorious/pipeline/clock_offset.h"

#include <cmath>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr double kMinOffset_s = 0.05;
constexpr double kMinSigmas = 3;
constexpr double kMaxOffset_s = 4;
constexpr double kMaxDuration_s = 20;

}  // namespace

std::optional<double> ClockCorrection(const TimeOffset& offset) {
  if (!offset.offset_s) return std::nullopt;
  const double size_s = std::abs(*offset.offset_s);
  return size_s > kMinOffset_s && size_s > kMinSigmas * offset.sigma_s ? offset.offset_s : std::nullopt;
}

Status CorrectClock(const std::string& video, double impulse_fraction, const CancelToken& cancel,
                    const WarningSink& warn, CameraStates& cameras) {
  if (!cameras.HasStates() || cameras.is_of_photos()) return {};
  const TimeOffsetOptions options{.max_offset_s = kMaxOffset_s, .max_duration_s = kMaxDuration_s};
  const Expected<ImageMotions> motions = MeasureMotions(video, options, impulse_fraction, cancel);
  if (!motions) {
    if (motions.error().code == ErrorCode::kCancelled) return std::unexpected(motions.error());
    warn("telemetry: the offset of its clock is unknown: " + motions.error().message);
    return {};
  }
  const TimeOffset offset = EstimateTimeOffset(*motions, *cameras.trajectory(), options);
  const std::optional<double> correction_s = ClockCorrection(offset);
  if (!correction_s) return {};
  cameras.ShiftClock(*correction_s);
  warn(
      fmt::format("telemetry: its clock is {:.2f} s {}: {:+.3f} s are added to its times, with a standard error of "
                  "{:.3f} s, estimated from the motion of the image; a given telemetry.time_offset_s is used as it is",
                  std::abs(*correction_s), *correction_s < 0 ? "late" : "early", *correction_s, offset.sigma_s));
  return {};
}

}  // namespace victorious
