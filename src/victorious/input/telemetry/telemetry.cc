#include "victorious/input/telemetry/telemetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/count_text.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/camera_csv.h"
#include "victorious/input/telemetry/camera_models.h"
#include "victorious/input/telemetry/dji_telemetry.h"
#include "victorious/input/telemetry/given_attitude.h"
#include "victorious/input/telemetry/klv_telemetry.h"
#include "victorious/input/telemetry/photo.h"
#include "victorious/input/telemetry/vertical_datum.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

// The texts of TelemetryOptions::vertical_datum.
constexpr auto kDatumTexts = DatumOverrideTexts<VerticalDatum::kTakeoff>();

// A change of position is a jump if it is faster than any aircraft with such a camera (about three times the speed of
// sound) and longer than kMinJump_m, the order of an error of a GPS receiver between two fixes.
constexpr double kMaxSpeed_m_s = 1000;
constexpr double kMinJump_m = 10;

// Keeps a longest subsequence of states with strictly increasing times. A clock that once jumps ahead thus costs one
// state, not all that follow it.
void KeepIncreasingTimes(Telemetry& telemetry) {
  const std::vector<CameraState>& states = telemetry.states;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> ends;  // last state of the increasing subsequence of length 1, 2, ... that ends earliest
  std::vector<std::size_t> before(states.size(), kNone);
  const auto time_of = [&](std::size_t i) { return states[i].time_s; };
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto end = std::ranges::lower_bound(ends, states[i].time_s, {}, time_of);
    if (end != ends.begin()) before[i] = *std::prev(end);
    if (end == ends.end()) {
      ends.push_back(i);
    } else if (states[i].time_s < time_of(*end)) {
      *end = i;
    }
  }
  std::vector<CameraState> increasing;
  for (std::size_t i = ends.empty() ? kNone : ends.back(); i != kNone; i = before[i]) increasing.push_back(states[i]);
  std::ranges::reverse(increasing);
  const std::size_t left_out = telemetry.states.size() - increasing.size();
  if (left_out > 0) {
    telemetry.warnings.push_back(fmt::format("{} of {} camera states are skipped: their time repeats or goes back",
                                             left_out, telemetry.states.size()));
  }
  telemetry.states = std::move(increasing);
}

void WarnOfJumps(Telemetry& telemetry, double max_gap_s) {
  int jumps = 0;
  int gaps = 0;
  for (std::size_t i = 1; i < telemetry.states.size(); ++i) {
    const CameraState& before = telemetry.states[i - 1];
    const CameraState& after = telemetry.states[i];
    const double seconds = after.time_s - before.time_s;
    const double metres = TangentPlane(before.place).EnuFromGeodetic(after.place).norm();
    jumps += metres > kMaxSpeed_m_s * seconds && metres > kMinJump_m ? 1 : 0;
    gaps += seconds > max_gap_s ? 1 : 0;
  }
  if (jumps > 0) {
    telemetry.warnings.push_back(
        fmt::format("the position jumps {}, faster than {:g} m/s", CountText(jumps, "time"), kMaxSpeed_m_s));
  }
  if (gaps > 0) {
    telemetry.warnings.push_back(fmt::format("{} of more than {:g} s: the camera state is unknown in {}",
                                             CountText(gaps, "gap"), max_gap_s, gaps == 1 ? "it" : "them"));
  }
}

// An attitude of a camera that flies is not exactly 0, 0, 0 in every state: these are placeholders of aircraft that do
// not record it, or of the program that converted it.
void RemovePlaceholderAttitudes(Telemetry& telemetry) {
  constexpr double kZero_rad = 1e-9;
  std::vector<CameraState>& states = telemetry.states;
  const auto is_zero = [&](const CameraState& state) {
    return state.attitude && std::abs(WrapAngle(state.attitude->yaw_rad)) < kZero_rad &&
           std::abs(state.attitude->pitch_rad) < kZero_rad && std::abs(WrapAngle(state.attitude->roll_rad)) < kZero_rad;
  };
  if (states.empty() || !std::ranges::all_of(states, is_zero)) return;
  const TangentPlane plane(states.front().place);
  const auto is_apart = [&](const CameraState& state) {
    return plane.EnuFromGeodetic(state.place).norm() >= kMinJump_m;
  };
  if (std::ranges::none_of(states, is_apart)) return;
  for (CameraState& state : states) state.attitude.reset();
  telemetry.warnings.push_back(fmt::format(
      "yaw, pitch and roll are exactly 0 in all {} camera states, though the camera moves: they are placeholders, and "
      "the attitude is unknown",
      states.size()));
}

// Says how many states lack something that others have.
void WarnOfIncomplete(const std::vector<CameraState>& states, std::vector<std::string>& warnings) {
  const auto warn = [&](auto has, std::string_view name) {
    const auto without = std::ranges::count_if(states, [&](const CameraState& state) { return !has(state); });
    if (without == 0 || static_cast<std::size_t>(without) == states.size()) return;
    warnings.push_back(fmt::format("{} of {} camera states have no {}: objects that are seen then get no place",
                                   without, states.size(), name));
  };
  warn([](const CameraState& state) { return state.hfov_rad.has_value(); }, "field of view");
  warn([](const CameraState& state) { return state.attitude.has_value(); }, "attitude");
  warn([](const CameraState& state) { return state.datum != VerticalDatum::kUnknown; }, "height");
}

// Names the flags that give what all states lack, in one line; std::nullopt if a state is complete, or there is none.
std::optional<std::string> FlagsForMissing(const std::vector<CameraState>& states) {
  const auto none = [&](auto has) { return std::ranges::none_of(states, has); };
  if (states.empty() || !none(&CameraState::IsComplete)) return std::nullopt;
  std::vector<std::string_view> flags;
  if (none([](const CameraState& state) { return state.attitude.has_value(); })) {
    flags.emplace_back("--nadir, or --pitch and --yaw (the gimbal angles)");
  }
  if (none([](const CameraState& state) { return state.hfov_rad.has_value(); })) {
    flags.emplace_back("--camera or --hfov (the field of view)");
  }
  const auto is_above_takeoff = [](const CameraState& state) { return state.datum == VerticalDatum::kTakeoff; };
  if (std::ranges::all_of(states, is_above_takeoff)) {
    flags.emplace_back("--takeoff (the height of the take-off above the ellipsoid)");
  }
  if (flags.empty()) return std::nullopt;
  return fmt::format("for places give {}", fmt::join(flags, "; and "));
}

// The steps common to all formats: options, order of times, checks, vertical datum.
Expected<Telemetry> Finish(Telemetry telemetry, const TelemetryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const CameraModel* camera = FindCameraModel(options.camera_model);
  // Telemetry's own fields of view are horizontal.
  const bool has_own =
      std::ranges::any_of(telemetry.states, [](const auto& state) { return state.hfov_rad.has_value(); });
  for (CameraState& state : telemetry.states) {
    state.time_s += options.time_offset_s;
    if (camera != nullptr && !state.hfov_rad) {
      state.hfov_rad = FieldOfView(*camera, std::nullopt);
      if (!has_own) telemetry.hfov_is_of_long_side = true;
    }
    if (options.hfov_deg) state.hfov_rad = RadiansFromDegrees(*options.hfov_deg);
  }
  if (options.hfov_deg) telemetry.hfov_is_of_long_side = false;
  KeepIncreasingTimes(telemetry);
  RemovePlaceholderAttitudes(telemetry);
  CompleteAttitudes(telemetry.states, options, telemetry.warnings);
  if (telemetry.format != TelemetryFormat::kPhotos) WarnOfJumps(telemetry, options.max_gap_s);
  VICTORIOUS_RETURN_IF_ERROR(ConvertToEllipsoid(telemetry.states, options, telemetry.warnings));
  if (telemetry.format != TelemetryFormat::kPhotos) WarnOfIncomplete(telemetry.states, telemetry.warnings);
  if (auto flags = FlagsForMissing(telemetry.states)) telemetry.warnings.push_back(*std::move(flags));
  return telemetry;
}

}  // namespace

void TelemetryOptions::ListFields(FieldList& fields) {
  fields.Add("time_offset_s", time_offset_s,
             {.min = -86400,
              .max = 86400,
              .unit = "s",
              .reason = "offset added to the telemetry's times, if its clock and the video's differ"});
  fields.Add(
      "clock_sigma_s", clock_sigma_s,
      {.min = 0,
       .max = 3600,
       .unit = "s",
       .reason = "sigma of the clock's offset where neither time_offset_s nor the motion of the image gives it; 0: "
                 "the clock is exact"});
  fields.Add("clock_sigma_apart_s", clock_sigma_apart_s,
             {.min = 0,
              .max = 3600,
              .unit = "s",
              .reason = "the same, if it is larger, of telemetry that begins or ends elsewhere than the video: it was "
                        "recorded apart, and 0.3 to 3 s are common"});
  fields.Add("max_gap_s", max_gap_s,
             {.min = 0.01,
              .max = 3600,
              .unit = "s",
              .reason = "maximum interval between states to interpolate: an aircraft may turn within seconds"});
  fields.Add("vertical_datum", vertical_datum, kDatumTexts,
             {.reason = "vertical datum of the heights; as_given: that of the format or the table"});
  fields.Add("gps_order", gps_order, kGpsOrderTexts,
             {.reason = "order of latitude and longitude in subtitles with GPS(a, b, height); by_text: latitude first "
                        "where the third number is a height"});
  fields.Add("geoid_grid", geoid_grid,
             {.reason = "a .gtx geoid grid, for heights above mean sea level; empty: PROJ's EGM96 grid, if installed"});
  fields.Add(
      "takeoff_altitude_m", takeoff_altitude_m,
      {.min = -1000,
       .max = 9000,
       .unit = "m",
       .reason = "height of the take-off above the ellipsoid, for heights relative to the take-off; null: unknown"});
  fields.Add("hfov_deg", hfov_deg,
             {.min = 0.01,
              .max = 179,
              .unit = "deg",
              .reason = "full horizontal field of view of the camera; null: from the telemetry"});
}

bool LooksLikeTelemetry(std::string_view bytes) {
  return StartsWithUniversalLabel(AsBytes(bytes)) || LooksLikeCameraCsv(bytes) || LooksLikeDjiSrt(bytes);
}

Expected<Telemetry> ParseTelemetry(std::string_view bytes, const TelemetryOptions& options) {
  if (LooksLikeCameraCsv(bytes)) {
    VICTORIOUS_ASSIGN_OR_RETURN(CameraRows rows, ParseCameraCsv(bytes));
    return Finish({.format = TelemetryFormat::kTable,
                   .states = std::move(rows.states),
                   .packets = {},
                   .records = rows.rows,
                   .warnings = std::move(rows.warnings)},
                  options);
  }
  if (LooksLikeDjiSrt(bytes)) return Finish(TelemetryFromDji(ParseDjiSrt(bytes, ReadingOf(options)), options), options);
  KlvPackets decoded = DecodeKlv(AsBytes(bytes));
  if (!decoded.packets.empty()) return Finish(TelemetryFromKlv(std::move(decoded), options.max_gap_s), options);
  if (!decoded.warnings.empty()) return Fail(ErrorCode::kDataLoss, decoded.warnings.Lines()[0]);
  return Fail(ErrorCode::kInvalidArgument, bytes.empty() ? "empty file: must be telemetry"
                                                         : fmt::format("no telemetry: must be {}", kTelemetryFiles));
}

Expected<Telemetry> TelemetryFromPackets(std::span<const DataPacket> packets, const TelemetryOptions& options) {
  KlvPackets decoded = DecodeKlv(packets);
  if (!decoded.packets.empty()) return Finish(TelemetryFromKlv(std::move(decoded), options.max_gap_s), options);
  DjiSubtitles subtitles = ParseSubtitlePackets(packets, ReadingOf(options));
  // A film's own subtitles are no telemetry; those of an aircraft without any position are, with its warnings.
  if (!subtitles.states.empty() || HasDjiSubtitle(packets))
    return Finish(TelemetryFromDji(std::move(subtitles), options), options);
  return Finish({.states = {}, .packets = {}, .records = 0, .warnings = decoded.warnings.Lines()}, options);
}

void FitToImage(int width, int height, Telemetry& telemetry) {
  if (!std::exchange(telemetry.hfov_is_of_long_side, false) || width <= 0 || height <= width) return;
  const double scale = static_cast<double>(width) / height;
  for (CameraState& state : telemetry.states) {
    if (state.hfov_rad) state.hfov_rad = 2 * std::atan(scale * std::tan(*state.hfov_rad / 2));
  }
  telemetry.warnings.push_back(fmt::format(
      "the picture is upright ({} x {}): the field of view of the focal length is that of its height", width, height));
}

Expected<Telemetry> TelemetryFromPhotos(std::span<const PhotoMetadata> photos, const TelemetryOptions& options) {
  Telemetry telemetry{.format = TelemetryFormat::kPhotos, .records = static_cast<int>(photos.size())};
  std::vector<double> takeoff_m;
  std::size_t turned = 0;
  for (const PhotoMetadata& photo : photos) {
    if (auto state = CameraFromPhoto(photo, HeightOf(options), options.camera_model))
      telemetry.states.push_back(*state);
    turned += photo.HasPlace() && !photo.is_upright ? 1 : 0;
    if (photo.altitude_m && photo.above_takeoff_m && photo.altitude_datum == VerticalDatum::kEgm96) {
      takeoff_m.push_back(*photo.altitude_m - *photo.above_takeoff_m);
    }
  }
  const std::size_t without_place = photos.size() - telemetry.states.size() - turned;
  if (without_place > 0) {
    telemetry.warnings.push_back(fmt::format("{} of {} photos have no position", without_place, photos.size()));
  }
  if (turned > 0) {
    telemetry.warnings.push_back(
        fmt::format("{} of {} photos are turned (EXIF orientation), which the gimbal's angles do not say: they give no "
                    "camera state",
                    turned, photos.size()));
  }
  WarnOfTakeoffHeight(std::move(takeoff_m), "AbsoluteAltitude", options, telemetry.warnings);
  return Finish(std::move(telemetry), options);
}

}  // namespace victorious
