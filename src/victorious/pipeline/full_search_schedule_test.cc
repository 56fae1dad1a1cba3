#include "victorious/pipeline/full_search_schedule.h"

#include <numbers>
#include <vector>

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
    schedule.SetSearched(frame);
    searched.push_back(index);
  }
  return searched;
}

Similarity2 Shift(double x_px) { return {.translation = {x_px, 0}}; }

TEST(FullSearchSchedule, SearchesAStillImageEachSecondAndWhereTracksRestart) {
  EXPECT_EQ(SearchedFramesOf(Shift(0)), (std::vector<std::int64_t>{0, 36, 60, 90, 120, 153}));
}

TEST(FullSearchSchedule, SearchesAFastImageInEachIntervalAsWithoutMotion) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(0), false);
  EXPECT_EQ(all.size(), 22U) << "20 multiples of 9 and two more of 60";
  EXPECT_EQ(SearchedFramesOf(Shift(9)), all) << "3 % of the diagonal in 3 frames, from 60 to 63";
}

TEST(FullSearchSchedule, SearchesAgainWhereTheImageHasMoved) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(1.4));
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 4)), (std::vector<std::int64_t>{0, 18, 36, 54}))
      << "3 % of 800 px are 24 px, 17 frames";
}

TEST(FullSearchSchedule, SearchesAgainWhereTheImageHasTurned) {
  const double turn_rad = 3 * std::numbers::pi / 180 / kInterval;
  Similarity2 turn{.rotation_rad = turn_rad};
  turn.translation = Eigen::Vector2d(320, 240) - turn.Linear() * Eigen::Vector2d(320, 240);
  const std::vector<std::int64_t> all = SearchedFramesOf(turn);
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 4)), (std::vector<std::int64_t>{0, 18, 36, 54}))
      << "a corner moves by 21 px in 9 frames";
}

TEST(FullSearchSchedule, SearchesAfterUnknownMotion) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(0), true, 0, 5);
  EXPECT_EQ((std::vector(all.begin(), all.begin() + 2)), (std::vector<std::int64_t>{0, 9}));
}

TEST(FullSearchSchedule, GoesOnTheSameFromARestartOfTracks) {
  const std::vector<std::int64_t> all = SearchedFramesOf(Shift(1));
  const std::vector<std::int64_t> rest = SearchedFramesOf(Shift(1), true, 120);
  EXPECT_EQ((std::vector(all.end() - std::ssize(rest), all.end())), rest);
}

}  // namespace
}  // namespace victorious
