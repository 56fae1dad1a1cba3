#include "victorious/base/utc.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstddef>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

// Reads an unsigned integer and removes it from the front.
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

// The digits after a decimal mark, in millionths; 0 if there are none.
std::int64_t TakeMicroseconds(std::string_view& text) {
  if (!TakeOneOf(text, ".,")) return 0;
  std::int64_t fraction = 0;
  for (std::int64_t place = 100'000; !text.empty() && text[0] >= '0' && text[0] <= '9'; place /= 10) {
    fraction += place * (text[0] - '0');
    text.remove_prefix(1);
  }
  return fraction;
}

// The offset of a zone from UTC: an empty text, "Z", "+02:00", "+0200" or "+02".
std::optional<std::chrono::minutes> TakeZone(std::string_view& text) {
  if (text.empty() || TakeOneOf(text, "Z")) return std::chrono::minutes(0);
  const int sign = text[0] == '-' ? -1 : 1;
  if (!TakeOneOf(text, "+-")) return std::nullopt;
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  auto number = TakeDigits(text);
  if (!number) return std::nullopt;
  if (digits == 4) return std::chrono::minutes(sign * (60 * (*number / 100) + *number % 100));
  if (digits != 2) return std::nullopt;
  const auto minutes = TakeOneOf(text, ":") ? TakeDigits(text) : std::optional(0);
  if (!minutes) return std::nullopt;
  return std::chrono::minutes(sign * (60 * *number + *minutes));
}

}  // namespace

std::int64_t NowUtcMicroseconds() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::string FormatUtc(std::int64_t microseconds, int decimals) {
  VICTORIOUS_CHECK(decimals >= 1 && decimals <= 6);
  namespace chr = std::chrono;
  const chr::sys_time<chr::microseconds> moment{chr::microseconds(microseconds)};
  const auto day = chr::floor<chr::days>(moment);
  const chr::year_month_day date(day);
  const chr::hh_mm_ss time(moment - day);
  const std::string fraction = fmt::format("{:06}", time.subseconds().count());
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), time.hours().count(),
                     time.minutes().count(), time.seconds().count(),
                     fraction.substr(0, static_cast<std::size_t>(decimals)));
}

std::optional<std::int64_t> ParseUtc(std::string_view text) {
  namespace chr = std::chrono;
  text = TrimBlanks(text);
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
  const auto offset = TakeZone(text);
  if (!date.ok() || !offset || !text.empty()) return std::nullopt;
  const chr::microseconds moment = chr::sys_days(date).time_since_epoch() + chr::hours(*hour) + chr::minutes(*minute) +
                                   chr::seconds(*second) + chr::microseconds(fraction_us) - *offset;
  return moment.count();
}

}  // namespace victorious
