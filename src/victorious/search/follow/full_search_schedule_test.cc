#include "victorious/search/follow/full_search_schedule.h"

#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr int kFrameRate = 30;
constexpr int kInterval = 9;
constexpr int kRestart = 60;

Frame FrameOf(std::int64_t index) {
  return {.index = index, .time_s = static_cast<double>(index) / kFrameRate, .image = cv::Mat(480, 640, CV_8UC1)};
}

// The frames from `first` to 180 that are searched, if each moves the image so; unknown in frame `unknown`.
std::vector<std::int64_t> SearchedFramesOf(const Similarity2& step, bool by_motion = true, std::int64_t first = 0,
                                           std::int64_t unknown = -1) {
  const FollowOptions follow{.restart_interval_frames = kRestart};
  FullSearchSchedule schedule(kInterval, follow, by_motion);
  std::vector<std::int64_t> searched;
  for (std::int64_t index = first; index < 180; ++index) {
    const Frame frame = FrameOf(index);
    if (!schedule.Enter(frame, index == first || index == unknown ? std::nullopt : std::optional(step))) continue;
    (void)schedule.SetSearched(frame, index == 0);
    searched.push_back(index);
  }
  return searched;
}

Similarity2 Shift(double x_px) { return {.translation = {x_px, 0}}; }

TEST(FullSearchSchedule, SearchesAStillImageAtTwoThirdsOfASecondAndWhereTracksRestart) {
  EXPECT_EQ(SearchedFramesOf(Shift(0)), (std::vector<std::int64_t>{0, 24, 48, 60, 84, 108, 120, 144, 168}));
}

TEST(FullSearchSchedule, SearchesAFastImageInEachIntervalAsWithoutMotion) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(0), false);
  EXPECT_EQ(all.size(), 22U) << "20 multiples of 9 and two more of 60";
  EXPECT_THAT(SearchedFramesOf(Shift(9)), ::testing::SizeIs(30))
      << "all multiples of 6, for a third of the views: 2 % of the diagonal, 16 px, are 2 frames";
}

TEST(FullSearchSchedule, SearchesAgainWhereTheImageHasMoved) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(1.4));
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 4)), (std::vector<std::int64_t>{0, 12, 24, 36}))
      << "2 % of 800 px are 16 px, 12 frames";
}

TEST(FullSearchSchedule, SearchesAgainWhereTheImageHasTurned) {
  const double turn_rad = 3 * std::numbers::pi / 180 / kInterval;
  Similarity2 turn{.rotation_rad = turn_rad};
  turn.translation = Eigen::Vector2d(320, 240) - turn.Linear() * Eigen::Vector2d(320, 240);
  const std::vector<std::int64_t> all = SearchedFramesOf(turn);
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 4)), (std::vector<std::int64_t>{0, 12, 24, 36}))
      << "a corner moves by 14 px in 6 frames";
}

TEST(SearchSpacing, GrowsWithThePixels) {
  EXPECT_EQ(SearchSpacing({640, 480}), 1) << "smaller frames are searched no more often";
  EXPECT_EQ(SearchSpacing({1280, 720}), 1);
  EXPECT_EQ(SearchSpacing({1920, 1080}), 2.25);
  EXPECT_EQ(SearchSpacing({3840, 2160}), 3);
}

TEST(FullSearchSchedule, SearchesLargeFramesMoreRarely) {
  const FollowOptions follow{.restart_interval_frames = 180};
  FullSearchSchedule schedule(kInterval, follow, true);
  std::vector<std::int64_t> searched;
  for (std::int64_t index = 0; index < 180; ++index) {
    const auto motion = index == 0 ? std::nullopt : std::optional(Shift(9));
    if (!schedule.Enter(FrameOf(index), motion, 2.5)) continue;
    (void)schedule.SetSearched(FrameOf(index), index == 0);
    searched.push_back(index);
  }
  ASSERT_GE(searched.size(), 4U);
  EXPECT_EQ((std::vector(searched.begin(), searched.begin() + 4)), (std::vector<std::int64_t>{0, 18, 36, 54}))
      << "the first multiple of 6 after 2.5 times 6 frames";
}

TEST(FullSearchSchedule, SearchesAfterUnknownMotion) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(0), true, 0, 5);
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 2)), (std::vector<std::int64_t>{0, 6}));
}

// The views of each search of a still image, at 30 frames/s.
std::vector<ViewPart> PartsOf(int interval, bool by_motion, std::int64_t first, std::int64_t restart) {
  const FollowOptions follow{.restart_interval_frames = static_cast<int>(restart)};
  FullSearchSchedule schedule(interval, follow, by_motion);
  std::vector<ViewPart> parts;
  for (std::int64_t index = first; index < 180; ++index) {
    const Frame frame = FrameOf(index);
    if (schedule.Enter(frame, index == first ? std::nullopt : std::optional(Shift(0)))) {
      parts.push_back(schedule.SetSearched(frame, index == 0));
    }
  }
  return parts;
}

TEST(FullSearchSchedule, SearchesForAThirdOfTheViewsInTurn) {
  const std::vector<ViewPart> parts = PartsOf(kInterval, true, 0, kRestart);
  EXPECT_EQ(parts, (std::vector<ViewPart>{{}, {0, 3}, {1, 3}, {1, 3}, {2, 3}, {0, 3}, {2, 3}, {0, 3}, {1, 3}}))
      << "from 60 on from the second part, from 120 on from the third";
  EXPECT_EQ(PartsOf(kInterval, true, 60, kRestart), (std::vector<ViewPart>(parts.begin() + 3, parts.end())));
}

TEST(FullSearchSchedule, LeavesNoViewsOutWhereTracksRestartOften) {
  const std::vector<ViewPart> parts = PartsOf(kInterval, true, 0, 30);
  for (std::size_t part = 0; part < 3; ++part) EXPECT_THAT(parts, ::testing::Contains(ViewPart{part, 3}));
}

TEST(FullSearchSchedule, SearchesForAllViewsInGivenFramesAndInEveryFrame) {
  EXPECT_THAT(PartsOf(kInterval, false, 0, kRestart), ::testing::Each(ViewPart{}));
  EXPECT_THAT(PartsOf(1, true, 0, kRestart), ::testing::Each(ViewPart{}));
}

TEST(FullSearchSchedule, GoesOnTheSameFromARestartOfTracks) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(1));
  const std::vector<std::int64_t> rest = SearchedFramesOf(Shift(1), true, 120);
  EXPECT_EQ((std::vector(all.end() - std::ssize(rest), all.end())), rest);
}

}  // namespace
}  // namespace victorious
