#include "victorious/place/calibrate/clock_prior.h"

#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

std::vector<CameraState> Rows(double from_s, double to_s, double interval_s = 0.1) {
  std::vector<CameraState> states;
  for (int i = 0; from_s + i * interval_s <= to_s + 1e-9; ++i) states.push_back({.time_s = from_s + i * interval_s});
  return states;
}

constexpr double kVideo_s = 20;

TEST(ClockPrior, TelemetryOfTheVideoWasRecordedWithIt) {
  for (const auto& rows : {Rows(0, 19.9), Rows(0.3, 20.2), Rows(-0.2, 20.4), Rows(0.7, 19.7, 1)}) {
    const ClockPrior prior = MakeClockPrior(rows, kVideo_s, {});
    EXPECT_EQ(prior.extent, TelemetryExtent::kOfVideo) << rows.front().time_s;
    EXPECT_EQ(prior.offset_s, 0);
    EXPECT_EQ(prior.sigma_s, TelemetryOptions().clock_sigma_s);
  }
}

TEST(ClockPrior, TelemetryAsLongAsTheVideoBeginsWithIt) {
  for (const double late_s : {1.0, 3.0, -1.7}) {
    const ClockPrior prior = MakeClockPrior(Rows(late_s, 19.9 + late_s), kVideo_s, {});
    EXPECT_EQ(prior.extent, TelemetryExtent::kDisplaced);
    EXPECT_DOUBLE_EQ(prior.offset_s, -late_s);
    EXPECT_EQ(prior.sigma_s, TelemetryOptions().clock_sigma_s);
  }
}

TEST(ClockPrior, OtherTelemetryWasRecordedApart) {
  for (const auto& rows : {Rows(-10, 30), Rows(0, 60), Rows(2, 19.9), Rows(40, 59.9)}) {
    const ClockPrior prior = MakeClockPrior(rows, kVideo_s, {});
    EXPECT_EQ(prior.extent, TelemetryExtent::kOther) << rows.front().time_s;
    EXPECT_EQ(prior.offset_s, 0);
    EXPECT_EQ(prior.sigma_s, TelemetryOptions().clock_sigma_apart_s);
  }
  EXPECT_EQ(MakeClockPrior(Rows(-10, 30), kVideo_s, {.clock_sigma_s = 5}).sigma_s, 5);
}

TEST(ClockPrior, OfAVideoOfUnknownLengthOnlyTheBeginningIsCompared) {
  EXPECT_EQ(MakeClockPrior(Rows(0, 60), std::nullopt, {}).extent, TelemetryExtent::kOfVideo);
  EXPECT_EQ(MakeClockPrior(Rows(3, 60), std::nullopt, {}).extent, TelemetryExtent::kOther);
}

TEST(ClockPrior, AClockThatIsGivenAsExactStaysSo) {
  for (const auto& rows : {Rows(0, 19.9), Rows(3, 22.9), Rows(-10, 30), std::vector<CameraState>()}) {
    const ClockPrior prior = MakeClockPrior(rows, kVideo_s, {.clock_sigma_s = 0});
    EXPECT_EQ(prior.offset_s, 0);
    EXPECT_EQ(prior.sigma_s, 0);
  }
}

TEST(ClockPrior, TelemetryBeforeTheFirstKeyFrameIsOfTheVideo) {
  const ClockPrior prior = MakeClockPrior(Rows(-0.7, 1.3), 1.4, {});
  EXPECT_EQ(prior.extent, TelemetryExtent::kOfVideo);
  EXPECT_EQ(prior.offset_s, 0);
  EXPECT_EQ(MakeClockPrior(Rows(-30, 20), kVideo_s, {}).extent, TelemetryExtent::kOther)
      << "longer than a key interval";
}

}  // namespace
}  // namespace victorious
