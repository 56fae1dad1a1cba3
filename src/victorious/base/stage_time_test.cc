#include "victorious/base/stage_time.h"

#include <cstdint>
#include <ctime>

#include <gtest/gtest.h>

namespace victorious {
namespace {

double TimeOf(Stage stage) { return StageTimes()[static_cast<std::size_t>(stage)]; }

// Computes until this thread has used some processor time.
void Compute() {
  constexpr std::int64_t kEnough_ns = 2'000'000;
  const auto now_ns = [] {
    std::timespec now = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
  };
  const std::int64_t start_ns = now_ns();
  while (now_ns() - start_ns < kEnough_ns) {
  }
}

TEST(StageTime, NothingCountsUntilMeasured) {
  {
    const StageScope scope(Stage::kMatching);
    Compute();
  }
  EXPECT_EQ(TimeOf(Stage::kMatching), 0);
}

TEST(StageTime, TheOutermostScopeCounts) {
  MeasureStages(true);
  {
    const StageScope outer(Stage::kTracking);
    Compute();
    const StageScope inner(Stage::kMatching);
    Compute();
  }
  {
    const StageScope next(Stage::kPoses);
    Compute();
  }
  MeasureStages(false);
  EXPECT_GE(TimeOf(Stage::kTracking), 0.004);
  EXPECT_EQ(TimeOf(Stage::kMatching), 0);
  EXPECT_GE(TimeOf(Stage::kPoses), 0.002);
}

TEST(StageTime, AMeasurementStartsAtZero) {
  MeasureStages(true);
  {
    const StageScope scope(Stage::kStore);
    Compute();
  }
  MeasureStages(true);
  MeasureStages(false);
  EXPECT_EQ(TimeOf(Stage::kStore), 0);
}

}  // namespace
}  // namespace victorious
