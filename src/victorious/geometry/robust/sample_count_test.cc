#include "victorious/geometry/robust/sample_count.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(SampleCount, BoundsTheProbabilityOfNoUncontaminatedSample) {
  const double needed = SamplesNeeded(0.5, 3, 0.99);
  EXPECT_NEAR(std::pow(1 - std::pow(0.5, 3), needed), 0.01, 1e-12);
  EXPECT_LT(SamplesNeeded(0.8, 3, 0.99), needed);
}

TEST(SampleCount, IsInfiniteWithoutInliersAndOneWithoutOutliers) {
  EXPECT_TRUE(std::isinf(SamplesNeeded(0, 2, 0.99)));
  EXPECT_EQ(SamplesNeeded(1, 2, 0.99), 1);
}

}  // namespace
}  // namespace victorious
