#include "victorious/input/telemetry/dji_srt.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <span>

#include <fmt/format.h>

#include "victorious/base/table_text.h"
#include "victorious/base/text.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/telemetry/camera_models.h"
#include "victorious/input/telemetry/subtitle_cues.h"

namespace victorious {
namespace {

bool IsWordCharacter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

// The text after the first occurrence of `word` as a whole word; std::nullopt if there is none.
std::optional<std::string_view> FindAfterWord(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::string_view rest = text.substr(at + word.size());
    const bool begins = at == 0 || !IsWordCharacter(text[at - 1]);
    if (begins && (rest.empty() || !IsWordCharacter(rest[0]))) return rest;
  }
  return std::nullopt;
}

void TrimFront(std::string_view& text) { text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size())); }

// A number with the letters that follow it as its unit: "25.1m", "11.5 W".
struct Quantity {
  double number = 0;
  std::string_view unit = {};
  bool has_point = false;  // a decimal point

  [[nodiscard]] bool IsHeight() const { return unit == "m" || unit == "M" || IsFeet(); }
  [[nodiscard]] bool IsFeet() const { return unit == "ft" || unit == "FT"; }
  [[nodiscard]] double Metres() const {
    constexpr double kMetresPerFoot = 0.3048;
    return IsFeet() ? kMetresPerFoot * number : number;
  }
  [[nodiscard]] bool IsNorthing() const { return unit == "N" || unit == "S"; }
  [[nodiscard]] bool IsEasting() const { return unit == "E" || unit == "W"; }
  // South and west are negative; the number may lack the sign.
  [[nodiscard]] double Degrees() const { return unit == "S" || unit == "W" ? -std::abs(number) : number; }
};

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Reads "-52,509" and removes it from the front; std::nullopt if no digits follow the comma at once, or if a comma or a
// point follows these, so that the end of the number is ambiguous.
std::optional<double> TakeNumberWithComma(std::string_view& text) {
  const auto end_of_digits = [&](std::size_t from) {
    return std::min(text.find_first_not_of("0123456789", from), text.size());
  };
  TrimFront(text);
  const std::size_t first = text.starts_with('-') ? 1 : 0;
  const std::size_t comma = end_of_digits(first);
  if (comma == first || comma == text.size() || text[comma] != ',') return std::nullopt;
  const std::size_t end = end_of_digits(comma + 1);
  if (end == comma + 1 || (end < text.size() && (text[end] == ',' || text[end] == '.'))) return std::nullopt;
  std::string number(text.substr(0, end));
  number[comma] = '.';
  text.remove_prefix(end);
  return ParseNumber(number);
}

// "W:", "N :".
bool StartsWithCompassLetter(std::string_view text) {
  if (text.empty() || std::string_view("NESW").find(text[0]) == std::string_view::npos) return false;
  text.remove_prefix(1);
  TrimFront(text);
  return text.starts_with(':');
}

// Reads the unit of a number, and removes it from the front.
Quantity TakeUnit(double number, std::string_view& text) {
  TrimFront(text);
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto end = std::ranges::find_if_not(text, is_letter);
  const Quantity quantity{.number = number, .unit = text.substr(0, static_cast<std::size_t>(end - text.begin()))};
  text.remove_prefix(quantity.unit.size());
  return quantity;
}

// Reads a quantity and removes it from the front. A letter of the compass may stand before the number: "W: 71.09".
std::optional<Quantity> TakeQuantity(std::string_view& text) {
  TrimFront(text);
  std::string_view letter;
  if (StartsWithCompassLetter(text)) {
    letter = text.substr(0, 1);
    text.remove_prefix(std::min(text.find(':') + 1, text.size()));
  }
  const std::string_view from = text;
  const auto number = TakeNumber(text);
  if (!number) return std::nullopt;
  const bool has_point = from.substr(0, from.size() - text.size()).contains('.');
  Quantity quantity = TakeUnit(*number, text);
  quantity.has_point = has_point;
  if (!letter.empty()) quantity.unit = letter;
  return quantity;
}

// The quantity after "word:" or "word :", also with a decimal comma; std::nullopt for a number whose end is ambiguous.
std::optional<Quantity> QuantityAfter(std::string_view text, std::string_view word) {
  auto rest = FindAfterWord(text, word);
  if (!rest) return std::nullopt;
  TrimFront(*rest);
  if (!rest->starts_with(':')) return std::nullopt;
  rest->remove_prefix(1);
  if (const auto number = TakeNumberWithComma(*rest)) return TakeUnit(*number, *rest);
  const auto quantity = TakeQuantity(*rest);
  const bool goes_on = rest->size() > 1 && rest->starts_with(',') && IsDigit((*rest)[1]);
  return goes_on ? std::nullopt : quantity;
}

std::optional<double> NumberAfter(std::string_view text, std::string_view word) {
  const auto quantity = QuantityAfter(text, word);
  return quantity ? std::optional(quantity->number) : std::nullopt;
}

// The three numbers of "word (a, b, c)". Numbers with a decimal comma are not supported: it reads as a separator.
using Triple = std::array<Quantity, 3>;

std::optional<Triple> TripleAfter(std::string_view text, std::string_view word) {
  auto rest = FindAfterWord(text, word);
  if (!rest) return std::nullopt;
  TrimFront(*rest);
  if (!rest->starts_with('(')) return std::nullopt;
  Triple triple;
  for (Quantity& quantity : triple) {
    rest->remove_prefix(1);  // the bracket, or the comma
    const auto taken = TakeQuantity(*rest);
    if (!taken) return std::nullopt;
    quantity = *taken;
    const std::size_t end = rest->find_first_of(",)\n");
    if (end == std::string_view::npos) return std::nullopt;
    rest->remove_prefix(end);
  }
  return triple;
}

bool SetPlace(CameraState& state, const Quantity& latitude, const Quantity& longitude) {
  if (latitude.IsEasting() || longitude.IsNorthing()) return false;
  const double latitude_deg = latitude.Degrees();
  const double longitude_deg = longitude.Degrees();
  if (!(std::abs(latitude_deg) <= 90 && std::abs(longitude_deg) <= 180)) return false;
  if (latitude_deg == 0 && longitude_deg == 0) return false;
  state.place.latitude_rad = RadiansFromDegrees(latitude_deg);
  state.place.longitude_rad = RadiansFromDegrees(longitude_deg);
  return true;
}

void SetTakeoffHeight(CameraState& state, const Quantity& height) {
  state.place.altitude_m = height.Metres();
  state.datum = VerticalDatum::kTakeoff;
}

// A keyword of a height, with the datum it implies. SetHeight applies the last of those that the text has.
struct HeightWord {
  std::string_view word;
  VerticalDatum datum = VerticalDatum::kTakeoff;
};

void SetHeight(std::string_view text, std::span<const HeightWord> words, CameraState& state) {
  for (const auto& [word, datum] : words) {
    const auto height = QuantityAfter(text, word);
    if (!height) continue;
    state.place.altitude_m = height->Metres();
    state.datum = datum;
  }
}

// Reads "[latitude: …] [longitude: …]" and the heights beside it.
bool ReadBrackets(std::string_view text, DjiHeight height, CameraState& state) {
  const auto latitude = QuantityAfter(text, "latitude");
  auto longitude = QuantityAfter(text, "longitude");
  if (!longitude) longitude = QuantityAfter(text, "longtitude");
  if (!latitude || !longitude || !SetPlace(state, *latitude, *longitude)) return false;
  // "altitude" alone is above the sea for some aircraft and above the take-off for others: the weaker claim is used.
  constexpr HeightWord kAboveSea = {"abs_alt", VerticalDatum::kEgm96};
  constexpr std::array<HeightWord, 3> kSeaFirst = {{{"altitude"}, {"rel_alt"}, kAboveSea}};
  constexpr std::array<HeightWord, 3> kTakeoffFirst = {{kAboveSea, {"altitude"}, {"rel_alt"}}};
  SetHeight(text, height == DjiHeight::kAboveTakeoff ? kTakeoffFirst : kSeaFirst, state);
  return true;
}

// Whether the third number of "GPS(a, b, c)" is a height: it has a unit, or decimals, which a number of satellites has
// not.
bool IsHeightOfGps(const Quantity& third) { return third.IsHeight() || third.has_point; }

bool HasLetters(const Triple& gps) {
  return std::ranges::any_of(gps, [](const Quantity& part) { return part.IsNorthing() || part.IsEasting(); });
}

bool NeedsGuessOfOrder(const Triple& gps) {
  constexpr double kMaxLatitude_deg = 90;
  return !HasLetters(gps) && std::abs(gps[0].number) <= kMaxLatitude_deg &&
         std::abs(gps[1].number) <= kMaxLatitude_deg && IsHeightOfGps(gps[2]);
}

bool IsLatitudeFirst(const Triple& gps, GpsOrder order) {
  constexpr double kMaxLatitude_deg = 90;
  const auto& [first, second, third] = gps;
  if (HasLetters(gps)) return first.IsNorthing() || second.IsEasting();
  if (std::abs(first.number) > kMaxLatitude_deg) return false;
  if (std::abs(second.number) > kMaxLatitude_deg) return true;
  return order == GpsOrder::kByText ? IsHeightOfGps(third) : order == GpsOrder::kLatitudeFirst;
}

// Reads "GPS(…)".
bool ReadGps(std::string_view text, GpsOrder order, CameraState& state) {
  const auto gps = TripleAfter(text, "GPS");
  if (!gps) return false;
  const bool latitude_first = IsLatitudeFirst(*gps, order);
  if (!SetPlace(state, (*gps)[latitude_first ? 0 : 1], (*gps)[latitude_first ? 1 : 0])) return false;
  if (IsHeightOfGps((*gps)[2]) || IsAutelText(text)) SetTakeoffHeight(state, (*gps)[2]);
  constexpr std::array<HeightWord, 3> kWords = {{{"BAROMETER"}, {"Hb"}, {"ReH"}}};
  SetHeight(text, kWords, state);
  if (auto rest = FindAfterWord(text, "H")) {
    if (const auto height = TakeQuantity(*rest)) SetTakeoffHeight(state, *height);
  }
  return true;
}

std::optional<Attitude> ReadAttitude(std::string_view text) {
  if (const auto gimbal = TripleAfter(text, "G.PRY")) {
    const auto& [pitch, roll, yaw] = *gimbal;
    return AttitudeFromGimbal(yaw.number, pitch.number, roll.number);
  }
  return AttitudeFromGimbal(NumberAfter(text, "gb_yaw"), NumberAfter(text, "gb_pitch"), NumberAfter(text, "gb_roll"));
}

// "dzoom" and a "dzoom_ratio" in ten-thousandths are not in the focal length. A plain ratio, "dzoom_ratio: 4.00",
// stands beside a focal length in millimetres with decimals, which contains it: 643.30 is the 162 mm lens of a Mavic 3T
// zoomed four times.
double DigitalZoom(std::string_view text, bool focal_has_decimals) {
  constexpr double kParts = 10'000;
  constexpr double kMinParts = 1000;  // a ratio of this many is none of zoom
  const double ratio = NumberAfter(text, "dzoom_ratio").value_or(1);
  const bool in_parts = ratio >= kMinParts;
  const double zoom = NumberAfter(text, "dzoom").value_or(in_parts ? ratio / kParts : (focal_has_decimals ? 1 : ratio));
  return zoom >= 1 ? zoom : 1;
}

// Whether the number after "word:" has a decimal point or comma.
bool HasDecimals(std::string_view text, std::string_view word) {
  const std::string_view rest = FindAfterWord(text, word).value_or("");
  const std::size_t start = std::min(rest.find_first_of("0123456789"), rest.size());
  const std::size_t end = std::min(rest.find_first_not_of("0123456789", start), rest.size());
  const std::string_view fraction = rest.substr(end);
  return fraction.size() > 1 && (fraction[0] == '.' || fraction[0] == ',') && IsDigit(fraction[1]);
}

// From the 35 mm equivalent focal length. Some aircraft write whole tenths of millimetres: 280 is 28 mm. A number with
// decimals is in millimetres.
std::optional<double> ReadFieldOfView(std::string_view text) {
  constexpr double kMaxFocal_mm = 200;
  auto focal_mm = NumberAfter(text, "focal_len");
  if (!focal_mm || !(*focal_mm > 0)) return std::nullopt;
  const bool has_decimals = HasDecimals(text, "focal_len");
  if (*focal_mm > kMaxFocal_mm && !has_decimals) *focal_mm /= 10;
  return FieldOfViewFromFocal(*focal_mm * DigitalZoom(text, has_decimals));
}

// The time of a cue: its own, or that of the UTC time in its text relative to the first.
std::optional<double> CueTime(const Cue& cue, std::optional<std::int64_t>& first_utc_us) {
  if (cue.start_s) return cue.start_s;
  const auto utc_us = FindUtc(cue.text);
  if (!utc_us) return std::nullopt;
  if (!first_utc_us) first_utc_us = utc_us;
  return 1e-6 * static_cast<double>(*utc_us - *first_utc_us);
}

}  // namespace

std::optional<Attitude> AttitudeFromGimbal(std::optional<double> yaw_deg, std::optional<double> pitch_deg,
                                           std::optional<double> roll_deg) {
  if (!yaw_deg || !pitch_deg || !roll_deg || std::abs(*pitch_deg) > 180) return std::nullopt;
  // Gimbals that pass the vertical continue to count: the rotation is right, but its angles are outside the ranges of
  // Attitude. The conversion normalises them.
  const Attitude turns{RadiansFromDegrees(*yaw_deg), RadiansFromDegrees(*pitch_deg), RadiansFromDegrees(*roll_deg)};
  return AttitudeFromRotation(CameraFromEnu(turns));
}

bool IsAutelText(std::string_view text) {
  auto rest = FindAfterWord(text, "GPS");
  if (!rest) return false;
  TrimFront(*rest);
  if (!rest->starts_with('(')) return false;
  rest->remove_prefix(1);
  TrimFront(*rest);
  return StartsWithCompassLetter(*rest);
}

bool HasAmbiguousGpsOrder(std::string_view text) {
  const auto gps = TripleAfter(text, "GPS");
  return gps && NeedsGuessOfOrder(*gps);
}

std::optional<CameraState> CameraFromDjiText(std::string_view text, const DjiReading& reading) {
  CameraState state{.datum = VerticalDatum::kUnknown};
  if (!ReadBrackets(text, reading.height, state) && !ReadGps(text, reading.order, state)) return std::nullopt;
  state.attitude = ReadAttitude(text);
  state.hfov_rad = ReadFieldOfView(text);
  return state;
}

std::optional<double> TakeoffAltitudeFromDjiText(std::string_view text) {
  const auto above_sea = QuantityAfter(text, "abs_alt");
  const auto above_takeoff = QuantityAfter(text, "rel_alt");
  if (!above_sea || !above_takeoff) return std::nullopt;
  return above_sea->Metres() - above_takeoff->Metres();
}

std::optional<double> AmbiguousAltitudeFromDjiText(std::string_view text) {
  const auto height = QuantityAfter(text, "altitude");
  if (!height || QuantityAfter(text, "rel_alt") || QuantityAfter(text, "abs_alt")) return std::nullopt;
  return height->Metres();
}

void AddDjiRemarks(std::string_view text, DjiSubtitles& subtitles) {
  if (const auto takeoff_m = TakeoffAltitudeFromDjiText(text)) subtitles.takeoff_m.push_back(*takeoff_m);
  if (const auto height_m = AmbiguousAltitudeFromDjiText(text)) subtitles.ambiguous_m.push_back(*height_m);
  subtitles.ambiguous_orders += HasAmbiguousGpsOrder(text) ? 1 : 0;
  subtitles.is_autel = subtitles.is_autel || IsAutelText(text);
}

bool HasDjiKeyword(std::string_view text) {
  constexpr std::array<std::string_view, 7> kMarks = {"GPS(",    "GPS (",    "HOME(", "latitude",
                                                      "[iso : ", "FrameCnt", "SrtCnt"};
  return std::ranges::any_of(kMarks, [&](std::string_view mark) { return text.contains(mark); });
}

bool LooksLikeDjiSrt(std::string_view bytes) {
  constexpr std::size_t kHeadSize = 8192;
  const std::string head = Utf8FromText(bytes.substr(0, kHeadSize));
  return HasDjiKeyword(IsAss(head) ? bytes : std::string_view(head)) && !SplitCues(head).empty();
}

void WarnOfSkippedCues(int without_place, int without_time, DjiSubtitles& subtitles) {
  if (without_place > 0) {
    subtitles.warnings.push_back(
        fmt::format("{} of {} subtitles have no position (no GPS fix, or truncated)", without_place, subtitles.cues));
  }
  if (without_time > 0) {
    subtitles.warnings.push_back(fmt::format("{} of {} subtitles have no time", without_time, subtitles.cues));
  }
}

DjiSubtitles ParseDjiSrt(std::string_view bytes, const DjiReading& reading) {
  DjiSubtitles subtitles;
  const std::string text = Utf8FromText(bytes);
  std::optional<std::int64_t> first_utc_us;
  int without_place = 0;
  int without_time = 0;
  std::vector<Cue> cues = SplitCues(text);
  if (IsLastCueCut(cues, text)) {
    cues.pop_back();
    ++subtitles.cues;
    subtitles.warnings.emplace_back("the last subtitle is cut off: it is left out");
  }
  for (const Cue& cue : cues) {
    ++subtitles.cues;
    auto state = CameraFromDjiText(cue.text, reading);
    AddDjiRemarks(cue.text, subtitles);
    const auto time_s = CueTime(cue, first_utc_us);
    if (!state || !time_s) {
      ++(state ? without_time : without_place);
      continue;
    }
    state->time_s = *time_s;
    subtitles.states.push_back(*state);
  }
  WarnOfSkippedCues(without_place, without_time, subtitles);
  if (first_utc_us) {
    subtitles.warnings.emplace_back(
        "the subtitles have no cue times: the UTC times in their texts are used, relative to the first");
  }
  return subtitles;
}

}  // namespace victorious
