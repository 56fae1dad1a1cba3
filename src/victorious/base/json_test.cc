#include "victorious/base/json.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace victorious {
namespace {

using ::testing::HasSubstr;

TEST(ParseJson, AcceptsComments) {
  const auto parsed = ParseJson("{\"a\": [1, {\"a\": 2}], /* why */ \"b\": {\"a\": 3}}");
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ((*parsed)["a"][1]["a"], 2);
  EXPECT_EQ((*parsed)["b"]["a"], 3);
}

TEST(ParseJson, NamesDuplicateKeys) {
  for (const std::string bad : {R"({"fps": 5, "x": {"fps": 1}, "fps": 6})", R"([{}, {"x": {"fps": 1, "fps": 1}}])"}) {
    const auto parsed = ParseJson(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_EQ(parsed.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(parsed.error().message, "\"fps\": given twice");
  }
}

TEST(ParseStrictJson, TakesTheLastOfDuplicateKeysAndNoComments) {
  const auto parsed = ParseStrictJson("{\"a\": 1, \"a\": 2}");
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ((*parsed)["a"], 2);
  EXPECT_FALSE(ParseStrictJson("{} // why"));
}

TEST(DumpJson, KeepsTheOrderAndReplacesWhatIsNotUtf8) {
  EXPECT_EQ(DumpJson(nlohmann::ordered_json{{"b", 1}, {"a", "\xff"}}), "{\"b\":1,\"a\":\"\uFFFD\"}");
  EXPECT_EQ(DumpJson(nlohmann::json{{"a", {1}}}, 1), "{\n \"a\": [\n  1\n ]\n}");
}

TEST(ReplaceInvalidUtf8, KeepsValidText) {
  EXPECT_EQ(ReplaceInvalidUtf8("\"\u00e4\"\n"), "\"\u00e4\"\n");
  EXPECT_EQ(ReplaceInvalidUtf8("a\xff"), "a\uFFFD");
}

TEST(ParseJson, ArbitraryBytesAreSafe) {
  for (const std::string bad : {"", "{", "{\"a\":", "{\"a\": 1, \"a\"", "}", "\xff{", "nul", "{\"\xff\": 1}"}) {
    const auto parsed = ParseJson(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_THAT(parsed.error().message, HasSubstr("not JSON"));
    EXPECT_FALSE(ParseStrictJson(bad)) << bad;
  }
}

}  // namespace
}  // namespace victorious
