#include "victorious/apps/serve/list_freshness.h"

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr ListFreshness::Clock::time_point kStart(seconds(1000));
const Error kGone{ErrorCode::kNotFound, "index.db: no such file"};

TEST(ListFreshness, HasNoAgeWhileTheListsAreRead) {
  ListFreshness lists;
  EXPECT_FALSE(lists.Succeeded(kStart));
  EXPECT_TRUE(lists.MayTry(kStart));
  EXPECT_EQ(lists.Age(kStart + seconds(3600)), seconds(0)) << "nobody asked for an hour";
}

TEST(ListFreshness, GivesOutOldListsForAWhile) {
  ListFreshness lists;
  lists.Succeeded(kStart);
  const auto begun = kStart + seconds(600);
  EXPECT_TRUE(lists.Failed(kGone, begun, begun + milliseconds(500)));
  EXPECT_EQ(lists.Age(begun + milliseconds(500)), seconds(601));
  EXPECT_FALSE(lists.MayTry(begun + milliseconds(900)));
  EXPECT_TRUE(lists.MayTry(begun + milliseconds(1500)));
  EXPECT_FALSE(lists.Failed(kGone, begun + seconds(2), begun + seconds(3))) << "told once";
  EXPECT_EQ(lists.Age(begun + seconds(29)), seconds(629));
}

TEST(ListFreshness, ThenGivesOutNone) {
  ListFreshness lists;
  lists.Succeeded(kStart);
  lists.Failed(kGone, kStart + seconds(1), kStart + seconds(1));
  lists.Failed(kGone, kStart + seconds(20), kStart + seconds(20));
  const auto age = lists.Age(kStart + seconds(31));
  ASSERT_FALSE(age);
  EXPECT_EQ(age.error().code, ErrorCode::kUnavailable);
  EXPECT_THAT(age.error().message, ::testing::HasSubstr("30 s: index.db: no such file"));
  EXPECT_TRUE(lists.Succeeded(kStart + seconds(40))) << "ends the failure";
  EXPECT_EQ(lists.Age(kStart + seconds(41)), seconds(0));
  EXPECT_TRUE(lists.Failed(kGone, kStart + seconds(50), kStart + seconds(50))) << "another failure";
  EXPECT_EQ(lists.Age(kStart + seconds(50)), seconds(10));
}

TEST(ListFreshness, WithoutAnyListsThereIsNothingToGiveOut) {
  ListFreshness lists;
  lists.Failed(kGone, kStart, kStart);
  EXPECT_FALSE(lists.Age(kStart));
}

}  // namespace
}  // namespace victorious
