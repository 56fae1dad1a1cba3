#include "victorious/telemetry/number_text.h"

#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\f\v";

// Takes a whole number without a sign off the front.
std::optional<int> TakeDigits(std::string_view& text) {
  int number = 0;
  if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool TakeOneOf(std::string_view& text, std::string_view marks) {
  if (text.empty() || !marks.contains(text[0])) return false;
  text.remove_prefix(1);
  return true;
}

// Digits after a decimal mark, in millionths; 0 where there are none.
std::int64_t TakeMicroseconds(std::string_view& text) {
  if (!TakeOneOf(text, ".,")) return 0;
  std::int64_t fraction = 0;
  for (std::int64_t place = 100'000; !text.empty() && text[0] >= '0' && text[0] <= '9'; place /= 10) {
    fraction += place * (text[0] - '0');
    text.remove_prefix(1);
  }
  return fraction;
}

}  // namespace

std::string_view WithoutBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<double> TakeNumber(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

std::optional<double> NumberIn(std::string_view text) {
  text = WithoutBlanks(text);
  const auto number = TakeNumber(text);
  return text.empty() ? number : std::nullopt;
}

std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> SplitAtCommas(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = std::min(line.find(','), line.size());
    cells.push_back(WithoutBlanks(line.substr(0, end)));
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

std::optional<std::int64_t> MicrosecondsOfUtc(std::string_view text) {
  namespace chr = std::chrono;
  text = WithoutBlanks(text);
  const auto year = TakeDigits(text);
  const bool dash = TakeOneOf(text, "-.");
  const auto month = TakeDigits(text);
  const bool dash2 = TakeOneOf(text, "-.");
  const auto day = TakeDigits(text);
  const bool between = TakeOneOf(text, "T ");
  const auto hour = TakeDigits(text);
  const bool colon = TakeOneOf(text, ":");
  const auto minute = TakeDigits(text);
  const bool colon2 = TakeOneOf(text, ":");
  const auto second = TakeDigits(text);
  if (!dash || !dash2 || !between || !colon || !colon2 || !second) return std::nullopt;
  if (*year > 9999 || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  const chr::year_month_day date(chr::year(*year), chr::month(static_cast<unsigned>(*month)),
                                 chr::day(static_cast<unsigned>(*day)));
  const std::int64_t fraction_us = TakeMicroseconds(text);
  if (!date.ok() || !(text.empty() || text == "Z")) return std::nullopt;
  const chr::microseconds moment = chr::sys_days(date).time_since_epoch() + chr::hours(*hour) + chr::minutes(*minute) +
                                   chr::seconds(*second) + chr::microseconds(fraction_us);
  return moment.count();
}

std::string UtcText(std::int64_t microseconds) {
  namespace chr = std::chrono;
  const chr::sys_time<chr::microseconds> moment{chr::microseconds(microseconds)};
  const auto day = chr::floor<chr::days>(moment);
  const chr::year_month_day date(day);
  const chr::hh_mm_ss time(moment - day);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), time.hours().count(),
                     time.minutes().count(), time.seconds().count(), time.subseconds().count());
}

}  // namespace victorious
