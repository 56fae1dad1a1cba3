#include "victorious/input/video/frame_clock.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

constexpr double kTick = 0.001;

TEST(FrameClock, StartsAtTheFirstFrame) {
  FrameClock clock(kTick, 0.04);
  EXPECT_DOUBLE_EQ(clock.Next(5000, 0).time_s, 0);
  EXPECT_DOUBLE_EQ(clock.Next(5033, 0).time_s, 0.033);
  EXPECT_DOUBLE_EQ(clock.Next(7000, 0.5).time_s, 2.0);
  EXPECT_DOUBLE_EQ(clock.end_time_s(), 2.5);
  EXPECT_DOUBLE_EQ(clock.origin_s().value(), 5.0);
}

TEST(FrameClock, MissingTimestampsAreFilledByDuration) {
  FrameClock clock(kTick, 0.04);
  EXPECT_DOUBLE_EQ(clock.Next(std::nullopt, 0.1).time_s, 0);
  EXPECT_FALSE(clock.origin_s());
  EXPECT_DOUBLE_EQ(clock.Next(std::nullopt, 0).time_s, 0.1);
  EXPECT_NEAR(clock.Next(9000, 0).time_s, 0.14, 1e-9);
  EXPECT_NEAR(clock.origin_s().value(), 8.86, 1e-9);
  EXPECT_NEAR(clock.Next(9040, 0).time_s, 0.18, 1e-9);
}

TEST(FrameClock, SingleBadTimestampIsReplaced) {
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

// The frame times that FrameClock computes for these stamps.
std::vector<double> TimesOf(FrameClock& clock, const std::vector<std::int64_t>& pts) {
  std::vector<double> times_s;
  for (std::size_t i = 0; i < pts.size(); ++i) {
    const auto following = [&] { return i + 1 < pts.size() ? std::optional(pts[i + 1]) : std::nullopt; };
    times_s.push_back(clock.Next(pts[i], 0, following).time_s);
  }
  return times_s;
}

TEST(FrameClock, SingleTimestampFarAheadIsReplaced) {
  for (const std::int64_t bad : {130, 200, 1000, 1'000'000'000}) {
    FrameClock clock(kTick, 0.04);
    EXPECT_THAT(TimesOf(clock, {0, 40, bad, 120, 160}), Pointwise(DoubleNear(1e-9), {0.0, 0.04, 0.08, 0.12, 0.16}))
        << bad;
  }
  FrameClock clock(kTick, 0.04);
  clock.Next(0, 0);
  EXPECT_TRUE(clock.Next(1'000'000, 0, [] { return 41; }).repaired);
  EXPECT_LT(clock.last_time_s(), 0.041);
  EXPECT_FALSE(clock.Next(41, 0).repaired);
}

TEST(FrameClock, GapsAreKept) {
  FrameClock clock(kTick, 0.04);
  EXPECT_THAT(TimesOf(clock, {0, 40, 1000, 1040, 1080}), Pointwise(DoubleNear(1e-9), {0.0, 0.04, 1.0, 1.04, 1.08}));
  // The stamp is accepted if it is the last one, or if the next stamp is consistent with it.
  EXPECT_DOUBLE_EQ(clock.Next(9000, 0, [] { return std::nullopt; }).time_s, 9.0);
  EXPECT_DOUBLE_EQ(clock.Next(12000, 0, [] { return 100; }).time_s, 12.0);
}

TEST(FrameClock, LooksAheadOnlyForJumps) {
  FrameClock clock(kTick, 0.04);
  const auto unasked = []() -> std::optional<std::int64_t> {
    ADD_FAILURE();
    return std::nullopt;
  };
  for (const std::int64_t pts : {5000, 5040, 5081, 5119, 5100, 5160}) clock.Next(pts, 0, unasked);
}

TEST(FrameClock, ConcatenatedRecordingsKeepTheirSpacing) {
  FrameClock clock(kTick, 0.04);
  clock.Next(10000, 0);
  clock.Next(10040, 0);
  const double joint_s = clock.Next(0, 0).time_s;
  EXPECT_NEAR(clock.Next(40, 0).time_s - joint_s, 0.04, 1e-9);
  EXPECT_FALSE(clock.Next(80, 0).repaired);
}

TEST(FrameClock, IsMonotonicAtIntegerOverflow) {
  FrameClock clock(1, 0.04);
  clock.Next(0, 0);
  double last_s = clock.Next(std::numeric_limits<std::int64_t>::max(), 0).time_s;
  for (const std::int64_t pts : {std::numeric_limits<std::int64_t>::max(), std::int64_t{5}, std::int64_t{6}}) {
    const double time_s = clock.Next(pts, 0).time_s;
    EXPECT_GT(time_s, last_s);
    last_s = time_s;
  }
}

TEST(FrameClock, IsStrictlyMonotonic) {
  constexpr std::uint64_t kSeed = 7;
  Random random(kSeed);
  FrameClock clock(1.0 / 90000, 0.04);
  double last_s = -1;
  for (int i = 0; i < 2000; ++i) {
    const auto pts = static_cast<std::int64_t>(random.Below(1'000'000));
    const auto following = [&] { return std::optional(static_cast<std::int64_t>(random.Below(1'000'000))); };
    const auto reading = clock.Next(random.Below(5) == 0 ? std::nullopt : std::optional(pts), 0, following);
    ASSERT_GT(reading.time_s, last_s) << "seed " << kSeed << ", frame " << i;
    last_s = reading.time_s;
  }
}

}  // namespace
}  // namespace victorious
