#include "victorious/jobs/index/search_pace.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

using std::chrono::milliseconds;

TEST(SearchPace, WithoutLimitAlwaysHasTime) {
  SearchPace pace(std::nullopt, false);
  pace.Enter(1e6);
  EXPECT_TRUE(pace.HasTime());
}

TEST(SearchPace, LiveSourceThatIsBehindIsNotSearched) {
  SearchPace pace(std::nullopt, true);
  pace.Enter(std::nullopt);
  EXPECT_FALSE(pace.HasTime()) << "frames that came before may wait";
  pace.Enter(0.05);
  EXPECT_TRUE(pace.HasTime());
  pace.Enter(0.3);
  EXPECT_FALSE(pace.HasTime());
  pace.Enter(0);
  EXPECT_TRUE(pace.HasTime());
}

TEST(SearchPace, LiveSourceHasNoBudget) {
  SearchPace::Clock::time_point now{};
  SearchPace pace(milliseconds{33}, true, [&] { return now; });
  for (int frame = 0; frame < 10; ++frame) {
    pace.Enter(0);
    now += milliseconds{40};  // until the next frame is filmed
    EXPECT_TRUE(pace.HasTime());
  }
  EXPECT_FALSE(pace.MissedBudget());
}

TEST(SearchPace, OneFrameOfALiveSourceIsSearchedAtATime) {
  for (const bool is_live : {false, true}) {
    SearchPace pace(std::nullopt, is_live);
    pace.Enter(0);
    EXPECT_TRUE(pace.HasTimeForAll());
    pace.BeginFullSearch();
    EXPECT_EQ(pace.HasTimeForAll(), !is_live);
    EXPECT_TRUE(pace.HasTime());
    pace.EndFullSearch();
    EXPECT_TRUE(pace.HasTimeForAll());
  }
}

TEST(SearchPace, HoldsItsBudget) {
  constexpr milliseconds kBudget{33};
  constexpr milliseconds kSearch{200};
  constexpr milliseconds kTracking{5};
  constexpr int kFrames = 1000;
  SearchPace::Clock::time_point now{};
  SearchPace pace(kBudget, false, [&] { return now; });
  int searched = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    pace.Enter(0);
    if (pace.HasTime()) {
      ++searched;
      now += kSearch;
    }
    now += kTracking;
  }
  EXPECT_LE(now - SearchPace::Clock::time_point{}, kBudget * kFrames + kSearch + kTracking);
  EXPECT_NEAR(searched, (kBudget - kTracking) * kFrames / kSearch, 1);
  EXPECT_FALSE(pace.MissedBudget());
}

TEST(SearchPace, SaysWhatAFrameTookIfTrackingAloneTakesLonger) {
  constexpr milliseconds kTracking{50};
  SearchPace::Clock::time_point now{};
  SearchPace pace(milliseconds{33}, false, [&] { return now; });
  EXPECT_FALSE(pace.MissedBudget());
  for (int frame = 0; frame < 10; ++frame) {
    pace.Enter(0);
    now += kTracking;
  }
  EXPECT_EQ(pace.MissedBudget(), kTracking);
}

}  // namespace
}  // namespace victorious
