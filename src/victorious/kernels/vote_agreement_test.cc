#include "victorious/kernels/vote_agreement.h"

#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

std::vector<float> RandomValues(std::size_t count, double range, Random& random) {
  std::vector<float> values(count + kVotePadding);  // the padding is a place where others are, too
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<float>(range * (2 * random.Uniform() - 1));
  return values;
}

struct Votes {
  std::vector<float> x, y, turn_rad;
  std::vector<VoteWindow> windows;

  Votes(std::uint32_t count, Random& random)
      : x(RandomValues(count, 50, random)),
        y(RandomValues(count, 50, random)),
        turn_rad(RandomValues(count, std::numbers::pi, random)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t begin = random.Below(i + 1);
      const std::uint32_t end = i + 1 + random.Below(count - i);
      windows.push_back({begin, end, static_cast<float>(2000 * random.Uniform())});
    }
  }
  VoteArrays View() const { return {x.data(), y.data(), turn_rad.data()}; }
};

TEST(CountAgreeingVotes, ComparesPlaceAndTheSmallerAngleInTheWindow) {
  std::vector<float> x = {0, 3, 0, 0, 0};
  std::vector<float> y = {0, 4, 0, 0, 0};
  std::vector<float> turn_rad = {3.1F, 3.1F, -3.1F, 2.0F, 3.1F};
  for (std::vector<float>* values : {&x, &y, &turn_rad}) values->resize(5 + kVotePadding);
  const auto count_of_first = [&](std::uint32_t end, float reach2_px2) {
    const std::vector<VoteWindow> windows = {{0, end, reach2_px2}};
    std::vector<std::int32_t> counts(1);
    CountAgreeingVotesRef({x.data(), y.data(), turn_rad.data()}, windows, 0.5F, counts);
    return counts[0];
  };
  EXPECT_EQ(count_of_first(5, 25.1F), 4);  // all but the one that is turned by 1.1
  EXPECT_EQ(count_of_first(5, 25), 3);     // nearer than, not at
  EXPECT_EQ(count_of_first(2, 25.1F), 2);
}

TEST(FindAgreeingPairs, MapsTemplateToScene) {
  const auto padded = [](float value) {
    std::vector<float> values(1 + kVotePadding);
    values[0] = value;
    return values;
  };
  const std::vector<float> tx = padded(2), ty = padded(1), sx = padded(13), sy = padded(29);
  const SimilarityMap map{.a = 0, .b = 3, .shift_x = 13, .shift_y = 20};  // turned by 90 degrees, three times as large
  std::uint32_t pair[1 + kVotePadding];
  float error2_px2[1 + kVotePadding];  // (2, 1) -> (13 - 3, 20 + 6)
  const PairArrays pairs{tx.data(), ty.data(), sx.data(), sy.data()};
  EXPECT_EQ(FindAgreeingPairsRef(pairs, 0, 1, map, 18, pair, error2_px2), 1U);
  EXPECT_EQ(error2_px2[0], 18);
  EXPECT_EQ(FindAgreeingPairsRef(pairs, 0, 1, map, 17.9F, pair, error2_px2), 0U);
}

class VoteAgreementTarget : public TargetTest {};

TEST_P(VoteAgreementTarget, CountsAsTheReference) {
  Random random(3);
  for (const std::uint32_t count : {1U, 2U, 7U, 16U, 17U, 63U, 400U}) {
    const Votes votes(count, random);
    std::vector<std::int32_t> counts(count), expected(count);
    CountAgreeingVotes(votes.View(), votes.windows, 0.5F, counts);
    CountAgreeingVotesRef(votes.View(), votes.windows, 0.5F, expected);
    EXPECT_EQ(counts, expected) << count << " votes";
  }
}

TEST_P(VoteAgreementTarget, FindsThePairsOfTheReference) {
  Random random(4);
  for (const std::size_t count : {1U, 5U, 16U, 31U, 33U, 500U}) {
    const std::vector<float> tx = RandomValues(count, 80, random), ty = RandomValues(count, 80, random);
    const std::vector<float> sx = RandomValues(count, 40, random), sy = RandomValues(count, 40, random);
    const PairArrays pairs{tx.data(), ty.data(), sx.data(), sy.data()};
    const SimilarityMap map{.a = 0.4F, .b = -0.3F, .shift_x = 3, .shift_y = -5};
    const auto find = [&](auto function, std::size_t begin) {
      std::vector<std::uint32_t> pair(count + kVotePadding);
      std::vector<float> error2_px2(count + kVotePadding);
      const std::size_t found = function(pairs, begin, count, map, 700.0F, pair.data(), error2_px2.data());
      pair.resize(found);
      error2_px2.resize(found);
      return std::pair(pair, error2_px2);
    };
    for (const std::size_t begin : {std::size_t{0}, count / 2, count}) {
      EXPECT_EQ(find(&FindAgreeingPairs, begin), find(&FindAgreeingPairsRef, begin)) << count << " pairs";
    }
  }
}

VICTORIOUS_EVERY_TARGET(VoteAgreementTarget);

}  // namespace
}  // namespace victorious::kernels
