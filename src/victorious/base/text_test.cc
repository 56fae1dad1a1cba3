#include "victorious/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

TEST(Text, CsvRowsSplitAtUnquotedCommas) {
  EXPECT_THAT(SplitRow("a, b ,,c"), ElementsAre("a", "b", "", "c"));
  EXPECT_THAT(SplitRow(R"("time_s","a, b","say ""no""")"), ElementsAre("time_s", "a, b", R"(say "no")"));
  EXPECT_THAT(SplitRow(""), ElementsAre(""));
  EXPECT_THAT(SplitRow(R"("never closed, and on)"), ElementsAre("never closed, and on"));
}

TEST(Text, LowerCaseChangesLettersOnly) {
  EXPECT_EQ(LowerCase(".JPeG-1"), ".jpeg-1");
  EXPECT_EQ(LowerCase("\xC3\x84"), "\xC3\x84");  // a letter beyond ASCII
}

TEST(Text, LinesEndWithLfOrCrLf) {
  std::string_view text = StripByteOrderMark("\xEF\xBB\xBFone\r\ntwo\n\nfour");
  EXPECT_EQ(TakeLine(text), "one");
  EXPECT_EQ(TakeLine(text), "two");
  EXPECT_EQ(TakeLine(text), "");
  EXPECT_EQ(TakeLine(text), "four");
  EXPECT_TRUE(text.empty());
}

TEST(Text, NumbersMustFillTheWholeCell) {
  EXPECT_EQ(ParseNumber(" +1.5 "), 1.5);
  EXPECT_EQ(ParseNumber("-2e3"), -2000);
  for (const char* none : {"", "1,5", "1 m", "nan", "inf", "1e999", "0x10", "+-1"})
    EXPECT_FALSE(ParseNumber(none)) << none;
  std::string_view text = " 25.1m";
  EXPECT_EQ(TakeNumber(text), 25.1);
  EXPECT_EQ(text, "m");
}

TEST(Text, IntegersMustFillTheWholeText) {
  EXPECT_EQ(ParseInteger("-12"), -12);
  EXPECT_EQ(ParseInteger("9223372036854775807"), 9223372036854775807);
  for (const char* none : {"", " 1", "1 ", "+1", "1.0", "0x10", "9223372036854775808", "one"})
    EXPECT_FALSE(ParseInteger(none)) << none;
}

}  // namespace
}  // namespace victorious
