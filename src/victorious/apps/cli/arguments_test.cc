#include "victorious/apps/cli/arguments.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/apps/cli/argument_parser.h"

namespace victorious::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// The parser's error message for these words; empty if they are accepted.
std::string ParseErrorText(const std::vector<std::string>& words, FilterArguments& filter) {
  ProgramParser parser("list", "Lists");
  filter.AddTo(parser);
  const auto ended = ParseArguments(parser, words);
  return ended ? "" : ended.error().message;
}

TEST(FilterArguments, TimesAreNonNegativeSeconds) {
  FilterArguments filter;
  EXPECT_EQ(ParseErrorText({"--from", "0", "--to", "1.5e2"}, filter), "");
  EXPECT_EQ(filter.Filter().value().from_s, 0.0);
  EXPECT_EQ(filter.Filter().value().to_s, 150.0);
  for (const std::string flag : {"--from", "--to"}) {
    for (const std::string bad : {"nan", "-nan", "-1", "-0.001", "inf", "1e999", "soon", "1s", "0x10", "1:60", "1:"}) {
      EXPECT_THAT(ParseErrorText({flag, bad}, filter), AllOf(HasSubstr(flag), HasSubstr(bad), Not(HasSubstr("\n"))))
          << flag << ' ' << bad;
    }
  }
}

TEST(FilterArguments, TimesMayHaveMinutesAndHours) {
  FilterArguments filter;
  EXPECT_EQ(ParseErrorText({"--from", "1:30", "--to", "1:02:03.5"}, filter), "");
  EXPECT_EQ(filter.Filter().value().from_s, 90.0);
  EXPECT_EQ(filter.Filter().value().to_s, 3723.5);
}

TEST(ParseTime, AcceptsHoursMinutesSeconds) {
  for (const auto& [text, seconds] : std::vector<std::pair<std::string, double>>{{"0", 0},
                                                                                 {"7.25", 7.25},
                                                                                 {"1e3", 1000},
                                                                                 {"90", 90},
                                                                                 {"0:00", 0},
                                                                                 {"1:30", 90},
                                                                                 {"1:5", 65},
                                                                                 {"75:00", 4500},
                                                                                 {"2:00:00", 7200},
                                                                                 {"100:59:59.75", 363599.75}}) {
    const Expected<double> parsed = ParseTime(text);
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_DOUBLE_EQ(*parsed, seconds) << text;
  }
  for (const std::string bad : {"", ":", ":30", "1:", "1:60", "1:61:00", "1:00:60", "1:2:3:4", "1.5:00", "1:-5",
                                "-1:30", "1:+5", "1:1e1", "1: 30", "1:nan", "1::2", "1;30", "-0"}) {
    const Expected<double> parsed = ParseTime(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_THAT(parsed.error().message, AllOf(HasSubstr("\"" + bad + "\""), HasSubstr("1:30")));
  }
}

}  // namespace
}  // namespace victorious::cli
