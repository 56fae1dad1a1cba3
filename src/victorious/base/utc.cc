#include "victorious/base/utc.h"

#include <chrono>
#include <cstddef>

#include <fmt/format.h>

#include "victorious/base/check.h"

namespace victorious {

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

}  // namespace victorious
