#include "victorious/input/telemetry/subtitle_cues.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "victorious/base/text.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxUtcLength = 40;  // maximum length of a line that may be a date and time

// Reads "01:02:03,456" as seconds and removes it from the front.
std::optional<double> TakeCueTime(std::string_view& text) {
  double seconds = 0;
  for (int part = 0; part < 3; ++part) {
    if (part > 0) {
      if (!text.starts_with(':')) return std::nullopt;
      text.remove_prefix(1);
    }
    const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
    const auto number = digits > 0 && digits < 6 ? ParseNumber(text.substr(0, digits)) : std::nullopt;
    if (!number) return std::nullopt;
    seconds = 60 * seconds + *number;
    text.remove_prefix(digits);
  }
  if (!text.starts_with(',') && !text.starts_with('.')) return seconds;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789", 1), text.size());
  const auto thousandths = ParseNumber(text.substr(1, digits - 1));
  text.remove_prefix(digits);
  return seconds + thousandths.value_or(0) / std::pow(10.0, static_cast<double>(digits - 1));
}

std::optional<double> CueStart(std::string_view line) {
  if (!line.contains("-->")) return std::nullopt;
  line = TrimBlanks(line);
  return TakeCueTime(line);
}

bool IsCueNumber(std::string_view line) {
  line = TrimBlanks(line);
  return !line.empty() && line.size() < 10 && line.find_first_not_of("0123456789") == std::string_view::npos;
}

// A cue starts with its number on a line of its own, followed by its times, or after an empty line by a date. The text
// may contain empty lines and numbers.
std::vector<Cue> SplitSrt(std::string_view text) {
  std::vector<Cue> cues;
  bool after_blank = true;
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    std::string_view ahead = text;
    const std::string_view next = TakeLine(ahead);
    const bool timed = next.contains("-->");
    const bool dated = FindUtc(next.substr(0, kMaxUtcLength)).has_value();
    if (IsCueNumber(line) && (timed || (after_blank && dated))) {
      cues.push_back({timed ? CueStart(next) : std::nullopt, {}});
      if (timed) text = ahead;
    } else if (!cues.empty()) {
      cues.back().text += line;
      cues.back().text += '\n';
    }
    after_blank = TrimBlanks(line).empty();
  }
  return cues;
}

// A text whose numbers are all "0": what the texts of one file have in common.
std::string Shape(std::string_view text) {
  std::string shape;
  for (const char c : TrimBlanks(text)) {
    const bool is_digit = c >= '0' && c <= '9';
    if (c == '-' || (is_digit && shape.ends_with('0'))) continue;
    shape += is_digit ? '0' : c;
  }
  return shape;
}

// Advanced SubStation Alpha: "Dialogue: 0,0:00:01.00,0:00:02.00,Default,,0,0,0,,text", the text after nine commas.
std::vector<Cue> SplitAss(std::string_view text) {
  constexpr std::string_view kDialogue = "Dialogue:";
  constexpr int kFieldsBeforeText = 9;
  std::vector<Cue> cues;
  while (!text.empty()) {
    std::string_view line = TakeLine(text);
    if (!line.starts_with(kDialogue)) continue;
    Cue cue;
    for (int field = 0; field < kFieldsBeforeText; ++field) {
      const std::size_t comma = std::min(line.find(','), line.size());
      if (field == 1) {
        std::string_view start = TrimBlanks(line.substr(0, comma));
        cue.start_s = TakeCueTime(start);
      }
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    cue.text = WithLineBreaks(line);
    cues.push_back(std::move(cue));
  }
  return cues;
}

}  // namespace

std::optional<std::int64_t> FindUtc(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = TrimBlanks(TakeLine(text)).substr(0, kMaxUtcLength);
    const std::size_t first_comma = line.find(',');
    const std::size_t second_comma =
        first_comma == std::string_view::npos ? first_comma : line.find(',', first_comma + 1);
    if (const auto moment = ParseUtc(line.substr(0, second_comma))) return moment;
  }
  return std::nullopt;
}

std::string WithLineBreaks(std::string_view text) {
  std::string lines;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool breaks = text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'N' || text[i + 1] == 'n');
    lines += breaks ? '\n' : text[i];
    i += breaks ? 1 : 0;
  }
  return lines;
}

bool IsAss(std::string_view text) { return TrimBlanks(text).starts_with("[Script Info]"); }

std::vector<Cue> SplitCues(std::string_view text) { return IsAss(text) ? SplitAss(text) : SplitSrt(text); }

bool IsLastCueCut(std::span<const Cue> cues, std::string_view text) {
  if (cues.empty() || text.ends_with('\n')) return false;  // the values of a whole last line are whole
  const std::string last = Shape(cues.back().text);
  if (cues.size() == 1) return !last.empty() && std::string_view(")]>").find(last.back()) == std::string_view::npos;
  const std::string before = Shape(cues[cues.size() - 2].text);
  if (last.size() < before.size() && before.starts_with(last)) return true;
  return std::ranges::count(last, '0') < std::ranges::count(before, '0');
}

}  // namespace victorious
