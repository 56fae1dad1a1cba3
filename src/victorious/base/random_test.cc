#include "victorious/base/random.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

TEST(Random, MatchesPublishedReferenceValues) {
  Random zero(0);
  EXPECT_EQ(zero.Next(), 0xE220A8397B1DCDAFU);
  EXPECT_EQ(zero.Next(), 0x6E789E6AA1B965F4U);
  EXPECT_EQ(zero.Next(), 0x06C45D188009454FU);
  Random other(1234567);
  for (const std::uint64_t value : {6457827717110365317U, 3203168211198807973U, 9817491932198370423U,
                                    4593380528125082431U, 16408922859458223821U}) {
    EXPECT_EQ(other.Next(), value);
  }
}

TEST(Random, DerivedDistributionsMatchGoldenValues) {
  Random random(7);
  EXPECT_EQ(random.Below(1000), 389U);
  EXPECT_EQ(random.Below(1000), 16U);
  EXPECT_DOUBLE_EQ(random.Uniform(), 0.9007606806068834);
  EXPECT_DOUBLE_EQ(random.Uniform(-3, 5), 1.6634423442246247);
  EXPECT_NEAR(random.Normal(), 0.00392020721518934, 1e-12);
}

TEST(Random, AdjacentSeedsGiveDifferentStreams) {
  Random a(1);
  Random b(2);
  for (int i = 0; i < 1000; ++i) EXPECT_NE(a.Next(), b.Next());
}

TEST(MixSeed, StreamsAreDistinctForEachSeed) {
  std::set<std::uint64_t> first_draws;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::uint64_t purpose = MixSeed(seed, 0x5A02);
    for (std::uint64_t frame = 0; frame < 100; ++frame) first_draws.insert(Random(MixSeed(purpose, frame)).Next());
  }
  EXPECT_EQ(first_draws.size(), 4000U);
}

TEST(Random, BelowRespectsBoundAtExtremes) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(random.Below(1), 0U);
    EXPECT_LT(random.Below(0xFFFFFFFFU), 0xFFFFFFFFU);
  }
  EXPECT_DEATH(random.Below(0), "check failed");
}

// Pearson's chi-squared of `draws` over equally likely bins.
double ChiSquared(const std::vector<int>& counts, int draws) {
  const double expected = static_cast<double>(draws) / static_cast<double>(counts.size());
  double sum = 0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

TEST(Random, BelowIsUniform) {
  constexpr int kDraws = 200'000;
  for (const std::uint32_t bound : {2U, 3U, 10U, 100U}) {
    Random random(bound);
    std::vector<int> counts(bound);
    for (int i = 0; i < kDraws; ++i) ++counts[random.Below(bound)];
    const double freedom = bound - 1;
    EXPECT_LT(ChiSquared(counts, kDraws), freedom + 4 * std::sqrt(2 * freedom)) << "bound " << bound;
  }
}

TEST(Random, UniformIsUniformOnUnitInterval) {
  constexpr int kDraws = 200'000;
  Random random(11);
  std::vector<int> counts(64);
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.Uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    ++counts[static_cast<std::size_t>(value * 64)];
  }
  EXPECT_LT(ChiSquared(counts, kDraws), 63 + 4 * std::sqrt(2 * 63.0));
}

TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  constexpr int kDraws = 200'000;
  Random random(13);
  std::array<double, 4> moments{};
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.Normal();
    ASSERT_TRUE(std::isfinite(value));
    double power = 1;
    for (double& moment : moments) moment += (power *= value) / kDraws;
  }
  EXPECT_NEAR(moments[0], 0, 0.01);
  EXPECT_NEAR(moments[1], 1, 0.02);
  EXPECT_NEAR(moments[2], 0, 0.04);
  EXPECT_NEAR(moments[3], 3, 0.1);
}

}  // namespace
}  // namespace victorious
