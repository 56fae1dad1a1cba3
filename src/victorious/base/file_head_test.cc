#include "victorious/base/file_head.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(FileHead, FirstLineEndsAtAnyLineBreak) {
  EXPECT_EQ(FirstLine("one\r\ntwo"), "one");
  EXPECT_EQ(FirstLine("one\ntwo"), "one");
  EXPECT_EQ(FirstLine("one"), "one");
  EXPECT_EQ(FirstLine(""), "");
}

TEST(FileHead, JsonLineNeedsAllMembers) {
  EXPECT_TRUE(IsJsonLine("{\"a\":1,\"b\":2}\nnot JSON", {"a", "b"}));
  EXPECT_FALSE(IsJsonLine("{\"a\":1}\n{\"b\":2}", {"a", "b"}));
  EXPECT_FALSE(IsJsonLine("[\"a\"]", {"a"}));
  EXPECT_FALSE(IsJsonLine("", {"a"}));
}

TEST(FileHead, JsonBeginsWithABrace) {
  EXPECT_TRUE(IsJsonWith(" \n{\"type\":\"FeatureCollection\"", {"\"FeatureCollection\""}));
  EXPECT_FALSE(IsJsonWith("x{\"FeatureCollection\"", {"\"FeatureCollection\""}));
  EXPECT_FALSE(IsJsonWith("{\"Feature\"", {"\"FeatureCollection\""}));
}

TEST(FileHead, TextOfSomeCharacters) {
  EXPECT_TRUE(IsTextOf("12.5", "0123456789."));
  EXPECT_FALSE(IsTextOf("12,5", "0123456789."));
  EXPECT_FALSE(IsTextOf("", "0123456789."));
}

}  // namespace
}  // namespace victorious
