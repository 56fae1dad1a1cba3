#include "victorious/base/utc.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(UtcTest, FormatsCalendarDates) {
  EXPECT_EQ(FormatUtc(0), "1970-01-01T00:00:00.000000Z");
  EXPECT_EQ(FormatUtc(951'782'400'000'000), "2000-02-29T00:00:00.000000Z") << "a leap year, divisible by 400";
  EXPECT_EQ(FormatUtc(4'107'542'400'000'000), "2100-03-01T00:00:00.000000Z") << "the day after 28 February";
  EXPECT_EQ(FormatUtc(1'779'887'662'911'042), "2026-05-27T13:14:22.911042Z");
  EXPECT_EQ(FormatUtc(253'402'300'799'999'999), "9999-12-31T23:59:59.999999Z");
}

TEST(UtcTest, TruncatesToTheGivenDecimals) {
  EXPECT_EQ(FormatUtc(1'779'887'662'911'942, 3), "2026-05-27T13:14:22.911Z");
  EXPECT_EQ(FormatUtc(999'999, 1), "1970-01-01T00:00:00.9Z");
  EXPECT_EQ(FormatUtc(-1, 3), "1969-12-31T23:59:59.999Z");
}

TEST(UtcTest, ParsesWhatItFormats) {
  for (const std::int64_t time_us : {std::int64_t{0}, std::int64_t{1'779'887'662'911'042}, std::int64_t{-1}}) {
    EXPECT_EQ(ParseUtc(FormatUtc(time_us)), time_us);
  }
  EXPECT_EQ(ParseUtc("1970-01-01 02:00:01.5+02:00"), 1'500'000);
  for (const char* text : {"", "1970-01-01", "1970-02-30T00:00:00Z", "1970-01-01T24:00:00Z", "1970-01-01T00:00:00Zx"}) {
    EXPECT_EQ(ParseUtc(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace victorious
