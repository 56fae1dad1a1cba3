#include "victorious/video/frame_clock.h"

#include <limits>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

constexpr double kTick = 0.001;

TEST(FrameClock, CountsFromTheFirstFrame) {
  FrameClock clock(kTick, 0.04);
  EXPECT_DOUBLE_EQ(clock.Next(5000, 0).time_s, 0);
  EXPECT_DOUBLE_EQ(clock.Next(5033, 0).time_s, 0.033);
  EXPECT_DOUBLE_EQ(clock.Next(7000, 0.5).time_s, 2.0);
  EXPECT_DOUBLE_EQ(clock.end_time_s(), 2.5);
  EXPECT_DOUBLE_EQ(clock.origin_s().value(), 5.0);
}

TEST(FrameClock, MissingStampsFollowByTheDuration) {
  FrameClock clock(kTick, 0.04);
  EXPECT_DOUBLE_EQ(clock.Next(std::nullopt, 0.1).time_s, 0);
  EXPECT_FALSE(clock.origin_s());
  EXPECT_DOUBLE_EQ(clock.Next(std::nullopt, 0).time_s, 0.1);
  EXPECT_NEAR(clock.Next(9000, 0).time_s, 0.14, 1e-9);
  EXPECT_NEAR(clock.origin_s().value(), 8.86, 1e-9);
  EXPECT_NEAR(clock.Next(9040, 0).time_s, 0.18, 1e-9);
}

TEST(FrameClock, OneBadStampDisturbsNoOther) {
  FrameClock clock(kTick, 0.04);
  clock.Next(0, 0);
  clock.Next(40, 0);
  const auto repaired = clock.Next(10, 0);
  EXPECT_TRUE(repaired.repaired);
  EXPECT_NEAR(repaired.time_s, 0.06, 1e-9);
  const auto good = clock.Next(80, 0);
  EXPECT_FALSE(good.repaired);
  EXPECT_NEAR(good.time_s, 0.08, 1e-9);
}

TEST(FrameClock, JoinedRecordingsKeepTheirSpacing) {
  FrameClock clock(kTick, 0.04);
  clock.Next(10000, 0);
  clock.Next(10040, 0);
  const double joint_s = clock.Next(0, 0).time_s;
  EXPECT_NEAR(clock.Next(40, 0).time_s - joint_s, 0.04, 1e-9);
  EXPECT_FALSE(clock.Next(80, 0).repaired);
}

TEST(FrameClock, ForwardsAtTheEndOfTheNumbers) {
  FrameClock clock(1, 0.04);
  clock.Next(0, 0);
  double last_s = clock.Next(std::numeric_limits<std::int64_t>::max(), 0).time_s;
  for (const std::int64_t pts : {std::numeric_limits<std::int64_t>::max(), std::int64_t{5}, std::int64_t{6}}) {
    const double time_s = clock.Next(pts, 0).time_s;
    EXPECT_GT(time_s, last_s);
    last_s = time_s;
  }
}

TEST(FrameClock, AlwaysForwardsWhateverComes) {
  constexpr std::uint64_t kSeed = 7;
  Random random(kSeed);
  FrameClock clock(1.0 / 90000, 0.04);
  double last_s = -1;
  for (int i = 0; i < 2000; ++i) {
    const auto pts = static_cast<std::int64_t>(random.Below(1'000'000));
    const auto reading = clock.Next(random.Below(5) == 0 ? std::nullopt : std::optional(pts), 0);
    ASSERT_GT(reading.time_s, last_s) << "seed " << kSeed << ", frame " << i;
    last_s = reading.time_s;
  }
}

}  // namespace
}  // namespace victorious
