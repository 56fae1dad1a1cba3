#include "victorious/telemetry/telemetry.h"

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
#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/telemetry/camera_csv.h"
#include "victorious/telemetry/camera_models.h"
#include "victorious/telemetry/dji_srt.h"
#include "victorious/telemetry/given_attitude.h"
#include "victorious/telemetry/klv_camera.h"
#include "victorious/telemetry/klv_packets.h"
#include "victorious/telemetry/klv_streams.h"
#include "victorious/telemetry/photo.h"
#include "victorious/telemetry/vertical_datum.h"
#include "victorious/types/vertical_datum.h"

namespace victorious {
namespace {

constexpr double kSecondsPerMicrosecond = 1e-6;

// The texts of TelemetryOptions::vertical_datum.
constexpr auto kDatumTexts = DatumOverrideTexts<VerticalDatum::kTakeoff>();

// Median angle between the optical axis and the recorded frame centre above which an angle does not follow the
// standard. Consistent systems have fractions of a degree; an angle with the wrong sign or zero gives tens of degrees.
constexpr double kMaxFrameCentreError_rad = RadiansFromDegrees(2);

// A change of position is a jump if it is faster than any aircraft with such a camera (about three times the speed of
// sound) and longer than kMinJump_m, the order of an error of a GPS receiver between two fixes.
constexpr double kMaxSpeed_m_s = 1000;
constexpr double kMinJump_m = 10;

// A take-off this far below the sea is taken for an error of the height: the dry land that people fly from is below -30
// m in a few basins only.
constexpr double kLowestTakeoff_m = -30;

// DJI's aircraft fly no higher than 500 m above their take-off: what is higher is above the sea. A clip that comes as
// low as this is of an aircraft that starts or lands, and its heights are above the take-off.
constexpr double kHighestAboveTakeoff_m = 500;
constexpr double kNearTakeoff_m = 5;

// Heights above the take-off are used where its height is known: the aircraft's own heights above the sea are often
// wrong by tens of metres.
DjiHeight HeightOf(const TelemetryOptions& options) {
  return options.takeoff_altitude_m ? DjiHeight::kAboveTakeoff : DjiHeight::kAboveSea;
}

bool HasBadChecksum(const KlvPacket& packet) { return packet.checksum && !packet.checksum->IsValid(); }

// The offset from the packets' own clock to the video's, s: the median difference of the packets that have both times;
// if none has, such that the first packet is at time 0. std::nullopt if no packet has its own time.
std::optional<double> ClockOffset(const std::vector<KlvPacket>& packets) {
  std::vector<double> offsets;
  std::optional<std::int64_t> first_us;
  for (const KlvPacket& packet : packets) {
    if (HasBadChecksum(packet)) continue;
    const auto own_us = PrecisionTime(packet);
    if (!own_us) continue;
    if (!first_us) first_us = own_us;
    if (packet.time_s) offsets.push_back(*packet.time_s - kSecondsPerMicrosecond * static_cast<double>(*own_us));
  }
  if (!offsets.empty()) return Median(std::move(offsets));
  if (first_us) return -kSecondsPerMicrosecond * static_cast<double>(*first_us);
  return std::nullopt;
}

// Adds the states of one stream's packets. The container's time takes precedence over the packet's own. Of several
// packets with the same container time the first has that time; the others are later by their own clock.
// @return the number of states without any time
int AddKlvStates(const std::vector<KlvPacket>& packets, Telemetry& telemetry) {
  int untimed = 0;
  const auto offset_s = ClockOffset(packets);
  const KlvPacket* first_at_time = nullptr;
  for (const KlvPacket& packet : packets) {
    if (HasBadChecksum(packet)) continue;
    if (packet.time_s && !(first_at_time != nullptr && first_at_time->time_s == packet.time_s)) first_at_time = &packet;
    auto state = CameraFromKlv(packet);
    if (!state) continue;
    if (packet.time_s) {
      const auto own_us = PrecisionTime(packet);
      const auto first_us = PrecisionTime(*first_at_time);
      if (own_us && first_us) state->time_s += kSecondsPerMicrosecond * static_cast<double>(*own_us - *first_us);
    } else {
      if (!state->utc_us || !offset_s) {
        ++untimed;
        continue;
      }
      state->time_s = *offset_s + kSecondsPerMicrosecond * static_cast<double>(*state->utc_us);
    }
    telemetry.states.push_back(*state);
  }
  return untimed;
}

void WarnOfClock(Telemetry& telemetry) {
  const auto timed = [](const KlvPacket& packet) { return packet.time_s.has_value(); };
  if (telemetry.states.empty() || std::ranges::any_of(telemetry.packets, timed)) return;
  telemetry.warnings.emplace_back(
      "the KLV packets have no video time: the first is at time 0; shift them by time_offset_s");
}

void WarnOfChecksums(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  const auto bad = std::ranges::count_if(packets, &HasBadChecksum);
  if (bad > 0) {
    warnings.push_back(
        fmt::format("{} of {} KLV packets fail their checksum: they give no camera state", bad, packets.size()));
  }
}

void WarnOfProblems(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  const auto has_problem = [](const KlvPacket& packet) { return !packet.problem.empty(); };
  const auto first = std::ranges::find_if(packets, has_problem);
  if (first == packets.end()) return;
  warnings.push_back(fmt::format("{} of {} KLV packets are readable only in part; the first at byte {}: {}",
                                 std::ranges::count_if(packets, has_problem), packets.size(), first->offset,
                                 first->problem));
}

void WarnOfFrameCentre(const std::vector<KlvPacket>& packets, std::vector<std::string>& warnings) {
  std::vector<double> errors_rad;
  for (const KlvPacket& packet : packets) {
    if (const auto error_rad = ComputeFrameCentreError(packet)) errors_rad.push_back(*error_rad);
  }
  if (errors_rad.empty()) return;
  const double median_rad = Median(std::move(errors_rad));
  if (median_rad <= kMaxFrameCentreError_rad) return;
  warnings.push_back(
      fmt::format("the sensor angles point {:.1f} degrees (median) away from the recorded frame centre: an angle does "
                  "not follow the "
                  "standard, and positions will be wrong",
                  DegreesFromRadians(median_rad)));
}

void WarnOfNoCamera(Telemetry& telemetry) {
  const bool local =
      std::ranges::find(telemetry.packets, KlvStandard::kSt0601, &KlvPacket::standard) != telemetry.packets.end();
  const auto missing = local ? FindMissingCameraItems(telemetry.packets) : std::vector<std::string_view>();
  telemetry.warnings.push_back(
      fmt::format("no packet has position, height and pointing of the camera{}{}",
                  missing.empty() ? "" : "; missing or marked unknown: ", fmt::join(missing, ", ")));
}

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

void WarnOfTakeoffHeight(std::vector<double> takeoff_m, std::string_view word, const TelemetryOptions& options,
                         std::vector<std::string>& warnings) {
  if (takeoff_m.empty() || HeightOf(options) == DjiHeight::kAboveTakeoff) return;
  const double median_m = Median(std::move(takeoff_m));
  if (median_m >= kLowestTakeoff_m) return;
  warnings.push_back(
      fmt::format("the heights above the sea ({}) put the take-off {:.0f} m below it, and the camera under the ground: "
                  "give --takeoff, the height of the take-off above the ellipsoid",
                  word, -median_m));
}

// Decides what "altitude" alone is above, where the heights tell it; else it stays the take-off, and a warning says so.
void ResolveAmbiguousHeights(const std::vector<double>& heights_m, const TelemetryOptions& options,
                             Telemetry& telemetry) {
  if (heights_m.empty() || options.vertical_datum) return;
  const auto [lowest, highest] = std::ranges::minmax_element(heights_m);
  if (*lowest < kNearTakeoff_m && *highest <= kHighestAboveTakeoff_m) return;
  constexpr std::string_view kFlag = "--vertical-datum takeoff or egm96 (the sea) says what they are above";
  if (*highest <= kHighestAboveTakeoff_m) {
    telemetry.warnings.push_back(
        fmt::format("the heights (altitude, {:.0f} to {:.0f} m) are taken for heights above the take-off, but some "
                    "aircraft write those above the sea there: {}",
                    *lowest, *highest, kFlag));
    return;
  }
  for (CameraState& state : telemetry.states) {
    if (state.datum == VerticalDatum::kTakeoff) state.datum = VerticalDatum::kEgm96;
  }
  telemetry.warnings.push_back(fmt::format(
      "the heights (altitude, up to {:.0f} m) are taken for heights above the sea: no such aircraft flies so "
      "high above its take-off; {}",
      *highest, kFlag));
}

// The steps common to all formats: options, order of times, checks, vertical datum.
Expected<Telemetry> Finish(Telemetry telemetry, const TelemetryOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const CameraModel* camera = FindCameraModel(options.camera_model);
  for (CameraState& state : telemetry.states) {
    state.time_s += options.time_offset_s;
    if (camera != nullptr && !state.hfov_rad) state.hfov_rad = FieldOfView(*camera, std::nullopt);
    if (options.hfov_deg) state.hfov_rad = RadiansFromDegrees(*options.hfov_deg);
  }
  KeepIncreasingTimes(telemetry);
  CompleteAttitudes(telemetry.states, options, telemetry.warnings);
  if (telemetry.format != TelemetryFormat::kPhotos) WarnOfJumps(telemetry, options.max_gap_s);
  VICTORIOUS_RETURN_IF_ERROR(ConvertToEllipsoid(telemetry.states, options, telemetry.warnings));
  if (auto flags = FlagsForMissing(telemetry.states)) telemetry.warnings.push_back(*std::move(flags));
  return telemetry;
}

TelemetryFormat FormatOf(KlvStandard standard) {
  switch (standard) {
    case KlvStandard::kSt0601:
      return TelemetryFormat::kSt0601;
    case KlvStandard::kEg0104:
      return TelemetryFormat::kEg0104;
    case KlvStandard::kOther:
      break;
  }
  return TelemetryFormat::kOtherKlv;
}

Expected<Telemetry> FromKlv(KlvPackets decoded, const TelemetryOptions& options) {
  Telemetry telemetry;
  telemetry.warnings = decoded.warnings.Lines();
  telemetry.packets = std::move(decoded.packets);
  telemetry.records = static_cast<int>(telemetry.packets.size());
  const CameraStream camera = SelectCameraStream(telemetry.packets, options.max_gap_s);
  if (camera.has_others) {
    telemetry.warnings.push_back(fmt::format(
        "several KLV streams: stream {} is used{}", camera.stream,
        camera.completed_by.empty() ? "" : fmt::format(", completed by {}", fmt::join(camera.completed_by, ", "))));
  }
  const int untimed = AddKlvStates(camera.packets, telemetry);
  if (untimed > 0) {
    telemetry.warnings.push_back(fmt::format(
        "{} KLV packets have a camera state but no time, neither their own (item 2) nor the video's", untimed));
  }
  const bool has_camera = untimed > 0 || !telemetry.states.empty();
  const auto known = std::ranges::find_if(
      telemetry.packets, [](const KlvPacket& packet) { return packet.standard != KlvStandard::kOther; });
  telemetry.format = known == telemetry.packets.end() ? TelemetryFormat::kOtherKlv : FormatOf(known->standard);
  WarnOfClock(telemetry);
  WarnOfChecksums(telemetry.packets, telemetry.warnings);
  WarnOfProblems(telemetry.packets, telemetry.warnings);
  WarnOfFrameCentre(telemetry.packets, telemetry.warnings);
  if (!has_camera && known != telemetry.packets.end()) WarnOfNoCamera(telemetry);
  return Finish(std::move(telemetry), options);
}

Expected<Telemetry> FromDji(DjiSubtitles subtitles, const TelemetryOptions& options) {
  Telemetry telemetry;
  telemetry.format = TelemetryFormat::kDjiSubtitles;
  telemetry.records = subtitles.cues;
  telemetry.states = std::move(subtitles.states);
  telemetry.warnings = std::move(subtitles.warnings);
  const CameraModel* camera = FindCameraModel(options.camera_model);
  const auto has_hfov = [](const CameraState& state) { return state.hfov_rad.has_value(); };
  if (camera != nullptr) {
    for (CameraState& state : telemetry.states) {
      if (state.hfov_rad) state.hfov_rad = FieldOfView(*camera, FocalFromFieldOfView(*state.hfov_rad));
    }
  } else if (!options.hfov_deg && std::ranges::any_of(telemetry.states, has_hfov)) {
    telemetry.warnings.emplace_back(
        "the field of view is estimated from the focal length, within 4 % for an uncropped image: --camera or --hfov "
        "gives it exactly");
  }
  WarnOfTakeoffHeight(std::move(subtitles.takeoff_m), "abs_alt", options, telemetry.warnings);
  ResolveAmbiguousHeights(subtitles.ambiguous_m, options, telemetry);
  return Finish(std::move(telemetry), options);
}

std::string_view TextOf(const DataPacket& packet) {
  return {reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()};
}

bool HasDjiSubtitle(std::span<const DataPacket> packets) {
  return std::ranges::any_of(packets, [](const DataPacket& packet) {
    return packet.kind == DataKind::kSubtitle && HasDjiKeyword(TextOf(packet));
  });
}

// Parses the subtitle packets of a video; a text may start with its length.
DjiSubtitles ParseSubtitlePackets(std::span<const DataPacket> packets, DjiHeight height) {
  DjiSubtitles subtitles;
  int without_place = 0;
  int without_time = 0;
  for (const DataPacket& packet : packets) {
    if (packet.kind != DataKind::kSubtitle) continue;
    ++subtitles.cues;
    const std::string_view text = TextOf(packet);
    auto state = CameraFromDjiText(text, height);
    AddDjiHeights(text, subtitles);
    if (!state || !packet.time_s) {
      ++(state ? without_time : without_place);
      continue;
    }
    state->time_s = *packet.time_s;
    subtitles.states.push_back(*state);
  }
  WarnOfSkippedCues(without_place, without_time, subtitles);
  return subtitles;
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
  if (LooksLikeDjiSrt(bytes)) return FromDji(ParseDjiSrt(bytes, HeightOf(options)), options);
  KlvPackets decoded = DecodeKlv(AsBytes(bytes));
  if (!decoded.packets.empty()) return FromKlv(std::move(decoded), options);
  if (!decoded.warnings.empty()) return Fail(ErrorCode::kDataLoss, decoded.warnings.Lines()[0]);
  return Fail(ErrorCode::kInvalidArgument, bytes.empty() ? "empty file: must be telemetry"
                                                         : fmt::format("no telemetry: must be {}", kTelemetryFiles));
}

Expected<Telemetry> TelemetryFromPackets(std::span<const DataPacket> packets, const TelemetryOptions& options) {
  KlvPackets decoded = DecodeKlv(packets);
  if (!decoded.packets.empty()) return FromKlv(std::move(decoded), options);
  DjiSubtitles subtitles = ParseSubtitlePackets(packets, HeightOf(options));
  // A film's own subtitles are no telemetry; those of an aircraft without any position are, with its warnings.
  if (!subtitles.states.empty() || HasDjiSubtitle(packets)) return FromDji(std::move(subtitles), options);
  return Finish({.states = {}, .packets = {}, .records = 0, .warnings = decoded.warnings.Lines()}, options);
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
