#include "victorious/cli/arguments.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// What parsing says against a command line; nothing if it takes it.
std::string Complaint(const std::string& line, FilterArguments& filter) {
  CLI::App app;
  filter.AddTo(app);
  try {
    app.parse(line);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(FilterArguments, TimesAreSecondsFromZeroOn) {
  FilterArguments filter;
  EXPECT_EQ(Complaint("--from 0 --to 1.5e2", filter), "");
  EXPECT_EQ(filter.Filter().value().from_s, 0.0);
  EXPECT_EQ(filter.Filter().value().to_s, 150.0);
  for (const std::string flag : {"--from", "--to"}) {
    for (const std::string bad : {"nan", "-nan", "-1", "-0.001", "inf", "1e999", "soon", "1s", "0x10"}) {
      EXPECT_THAT(Complaint(flag + " " + bad, filter), AllOf(HasSubstr(flag), HasSubstr(bad), Not(HasSubstr("\n"))))
          << flag << ' ' << bad;
    }
  }
}

}  // namespace
}  // namespace victorious::cli
