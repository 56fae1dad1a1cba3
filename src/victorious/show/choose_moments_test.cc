#include "victorious/show/choose_moments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

std::vector<MomentRank> Ranks(std::initializer_list<int> matches) {
  std::vector<MomentRank> ranks;
  for (const int one : matches) ranks.emplace_back(one, 0.5);
  return ranks;
}

TEST(ChooseMoments, TakesTheBestOfEachPart) {
  EXPECT_THAT(ChooseMoments(Ranks({1, 5, 2, 1, 9, 1, 3, 2, 1}), 3), ElementsAre(1, 4, 6));
  EXPECT_THAT(ChooseMoments(Ranks({1, 5, 2}), 1), ElementsAre(1));
}

TEST(ChooseMoments, NeighboursOnBothSidesOfABorderAreNotBothTaken) {
  EXPECT_THAT(ChooseMoments(Ranks({1, 2, 3, 8, 9, 1, 4, 1}), 2), ElementsAre(2, 4));
}

TEST(ChooseMoments, BestOfAllStaysAndFewSightingsAreAllTaken) {
  EXPECT_THAT(ChooseMoments(Ranks({3, 9, 2}), 5), ElementsAre(0, 1, 2));
  EXPECT_THAT(ChooseMoments(Ranks({1, 1, 1, 7, 6, 1}), 3), ElementsAre(0, 3, 4)) << "nothing of the last part is apart";
}

TEST(ChooseMoments, ScoreDecidesBetweenEqualMatches) {
  const std::vector<MomentRank> ranks = {{4, 0.2}, {4, 0.9}, {4, 0.5}};
  EXPECT_THAT(ChooseMoments(ranks, 1), ElementsAre(1));
}

}  // namespace
}  // namespace victorious
