#include "victorious/base/suggestion.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(EditDistance, CountsEditsAndSwaps) {
  EXPECT_EQ(EditDistance("", ""), 0U);
  EXPECT_EQ(EditDistance("index", "index"), 0U);
  EXPECT_EQ(EditDistance("", "db"), 2U);
  EXPECT_EQ(EditDistance("indx", "index"), 1U);
  EXPECT_EQ(EditDistance("serach", "search"), 1U);
  EXPECT_EQ(EditDistance("track", "rack"), 1U);
  EXPECT_EQ(EditDistance("model", "modal"), 1U);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3U);
}

TEST(FindNearest, IsAWordWithFewEdits) {
  const std::vector<std::string> commands = {"index", "search", "export", "experiment"};
  EXPECT_EQ(FindNearest("serach", commands), "search");
  EXPECT_EQ(FindNearest("indx", commands), "index");
  EXPECT_EQ(FindNearest("exprot", commands), "export");
  EXPECT_EQ(FindNearest("frobnicate", commands), std::nullopt);
  EXPECT_EQ(FindNearest("", commands), std::nullopt);
  EXPECT_EQ(FindNearest("index", {}), std::nullopt);
}

}  // namespace
}  // namespace victorious
