#include "victorious/search/recognize/recent_items.h"

#include <string>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(RecentItems, KeepsTheFirstItemOfAKey) {
  RecentItems<int, std::string> items(100);
  EXPECT_EQ(items.Find(1), nullptr);
  EXPECT_EQ(*items.Put(1, "first", 10), "first");
  EXPECT_EQ(*items.Put(1, "second", 10), "first");
  EXPECT_EQ(*items.Find(1), "first");
  EXPECT_EQ(items.size_bytes(), 10U);
}

TEST(RecentItems, StaysWithinItsBudget) {
  RecentItems<int, int> items(1000);
  for (int key = 0; key < 10'000; ++key) {
    items.Put(key, key, 30);
    ASSERT_LE(items.size_bytes(), 1000U);
  }
  EXPECT_EQ(items.Find(0), nullptr);
  EXPECT_EQ(*items.Find(9999), 9999);
}

TEST(RecentItems, EvictsWhatWasNotUsedForTheLongestTime) {
  RecentItems<int, int> items(100);
  for (const int key : {1, 2, 3, 4}) items.Put(key, key, 25);
  EXPECT_NE(items.Find(1), nullptr);
  const auto held = items.Find(2);
  EXPECT_NE(items.Find(1), nullptr);
  items.Put(5, 5, 25);
  EXPECT_EQ(items.Find(3), nullptr);
  EXPECT_EQ(items.Find(4), nullptr);
  EXPECT_NE(items.Find(1), nullptr);
  EXPECT_EQ(*held, 2);
}

}  // namespace
}  // namespace victorious
