#include "victorious/category/common/sampling.h"

#include <set>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(SampleIndices, AreDistinctAndDeterministicBySeed) {
  Random random(3);
  const auto drawn = SampleIndices(100, 30, random);
  EXPECT_EQ(drawn.size(), 30U);
  EXPECT_EQ(std::set(drawn.begin(), drawn.end()).size(), 30U);
  for (const std::uint32_t index : drawn) EXPECT_LT(index, 100U);
  Random again(3);
  EXPECT_EQ(SampleIndices(100, 30, again), drawn);
  EXPECT_NE(SampleIndices(100, 30, again), drawn);
}

TEST(SampleIndices, AreAllIfFewerThanRequested) {
  Random random(1);
  const auto drawn = SampleIndices(7, 30, random);
  EXPECT_EQ(std::set(drawn.begin(), drawn.end()).size(), 7U);
  EXPECT_TRUE(SampleIndices(0, 30, random).empty());
}

}  // namespace
}  // namespace victorious
