#include "victorious/place/associate/search_counts.h"

#include <utility>

#include <gtest/gtest.h>

#include "victorious/types/searched_frames.h"

namespace victorious {
namespace {

class SearchCountsTest : public ::testing::Test {
 protected:
  SearchCountsTest() {
    first_.record.video = 1;
    second_.record.video = 2;
  }

  ObservedTracklet first_;
  ObservedTracklet second_;
};

TEST_F(SearchCountsTest, OfTheVideosOfAnObjectOverAllModels) {
  SearchCounts counts;
  counts.Add(1, 300, 100.0);
  counts.Add(1, 200, 100.0);
  counts.Add(2, 40, std::nullopt);
  counts.Add(3, 1'000'000, 50.0);
  EXPECT_DOUBLE_EQ(counts.TestsOf({.tracklets = {&first_}, .estimate = {}, .absolute = {}}), 500);
  EXPECT_DOUBLE_EQ(counts.TestsOf({.tracklets = {&second_}, .estimate = {}, .absolute = {}}), 40);
  EXPECT_DOUBLE_EQ(counts.TestsOf({.tracklets = {&first_, &second_, &first_}, .estimate = {}, .absolute = {}}), 540);
}

TEST_F(SearchCountsTest, OfLongVideosThoseOfAnHour) {
  SearchCounts counts;
  counts.Add(1, 36'000, 7200.0);
  EXPECT_DOUBLE_EQ(counts.TestsOf({.tracklets = {&first_}, .estimate = {}, .absolute = {}}), 18'000);
  counts.Add(2, 12'000, 3600.0);
  EXPECT_DOUBLE_EQ(counts.TestsOf({.tracklets = {&first_, &second_}, .estimate = {}, .absolute = {}}), 16'000);
}

TEST(SearchedFrames, AreThoseOfTheIntervalAndOfRestarts) {
  for (const auto& [every, restart] : {std::pair<int, int>{1, 0}, {4, 0}, {9, 60}, {60, 9}, {1000, 60}, {7, 7}}) {
    const SearchedFrames frames{.every = every, .restart = restart};
    std::int64_t searched = 0;
    for (int end = 0; end < 400; ++end) {
      EXPECT_EQ(frames.CountBefore(end), searched) << every << ' ' << restart << ' ' << end;
      const bool is_searched = end % every == 0 || (restart > 0 && end % restart == 0);
      EXPECT_EQ(frames.Contains(end), is_searched) << every << ' ' << restart << ' ' << end;
      searched += is_searched ? 1 : 0;
    }
  }
}

TEST_F(SearchCountsTest, NothingIsKnownOfAnUnsearchedVideo) {
  EXPECT_EQ(SearchCounts().TestsOf({.tracklets = {&first_}, .estimate = {}, .absolute = {}}), 0);
}

}  // namespace
}  // namespace victorious
