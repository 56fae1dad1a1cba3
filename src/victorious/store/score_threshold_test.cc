#include "victorious/store/score_threshold.h"

#include <algorithm>
#include <initializer_list>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

std::vector<DecidedScore> Decisions(std::initializer_list<double> accepted, std::initializer_list<double> rejected) {
  std::vector<DecidedScore> decisions;
  for (const double score : accepted) decisions.push_back({score, true});
  for (const double score : rejected) decisions.push_back({score, false});
  return decisions;
}

TEST(LearnThreshold, SeparatesAcceptsFromRejects) {
  const auto found = LearnThreshold(Decisions({0.91, 0.95, 0.97, 0.98, 0.99, 0.99}, {0.31, 0.55, 0.7, 0.824}));
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->min_score, 0.83) << "just above the best reject: what lies between is not known to be false";
  EXPECT_EQ(found->rejected_below, 4);
  EXPECT_EQ(found->accepted_below, 0);
}

TEST(LearnThreshold, NeedsEnoughDecisions) {
  EXPECT_FALSE(LearnThreshold({}));
  EXPECT_FALSE(LearnThreshold(Decisions({0.91, 0.95, 0.97, 0.98, 0.99}, {0.31, 0.55, 0.7, 0.8})));
  EXPECT_FALSE(LearnThreshold(Decisions({0.91, 0.92, 0.95, 0.96, 0.97, 0.98, 0.99, 0.99}, {0.31, 0.55})))
      << "two rejects are chance";
}

// A real object that is missed costs as much as four false ones.
TEST(LearnThreshold, WeighsMissesByTheirCost) {
  EXPECT_FALSE(LearnThreshold(Decisions({0.1, 0.9, 0.95, 0.97, 0.98, 0.99}, {0.2, 0.3, 0.4, 0.5})));
  const auto found = LearnThreshold(Decisions({0.1, 0.9, 0.95, 0.97, 0.98, 0.99}, {0.2, 0.3, 0.4, 0.5, 0.6}));
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->min_score, 0.61);
  EXPECT_EQ(found->accepted_below, 1);
  EXPECT_EQ(found->rejected_below, 5);
}

TEST(LearnThreshold, AcceptsAloneGiveNone) { EXPECT_FALSE(LearnThreshold(std::vector<DecidedScore>(20, {0.4, true}))); }

TEST(LearnThreshold, RejectsAloneHideWhatIsNoBetter) {
  const auto found = LearnThreshold(std::vector<DecidedScore>(20, {0.4, false}));
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->min_score, 0.41);
  EXPECT_FALSE(LearnThreshold(std::vector<DecidedScore>(20, {1, false}))) << "no score is above 1";
}

TEST(LearnThreshold, TakesAsManyDecimalsAsItNeeds) {
  std::vector<DecidedScore> decisions(6, {0.9996, true});
  decisions.insert(decisions.end(), 6, {0.9991, false});
  EXPECT_DOUBLE_EQ(LearnThreshold(decisions)->min_score, 0.9992);
  for (int i = 0; i < 6; ++i) decisions[i].score = 0.9931;
  for (int i = 6; i < 12; ++i) decisions[i].score = 0.9911;
  EXPECT_DOUBLE_EQ(LearnThreshold(decisions)->min_score, 0.992);
}

// Equal scores cannot be parted: they are all above or all below.
TEST(LearnThreshold, KeepsEqualScoresTogether) {
  std::vector<DecidedScore> decisions(2, {0.5, true});
  decisions.insert(decisions.end(), 8, {0.5, false});
  EXPECT_FALSE(LearnThreshold(decisions)) << "two misses cost as much as eight false objects";
}

// The definition, over drawn decisions: no threshold costs less.
TEST(LearnThreshold, AgreesWithAllThresholds) {
  Random random(20);
  for (int round = 0; round < 200; ++round) {
    std::vector<DecidedScore> decisions;
    for (int i = 0; i < 12; ++i)
      decisions.push_back({0.01 * static_cast<double>(random.Below(100)), random.Below(3) == 0});
    const auto cost = [&](double min_score) {
      std::int64_t sum = 0;
      for (const DecidedScore& one : decisions) {
        if (one.is_accepted && one.score < min_score - 1e-9) sum += kMissCost;
        if (!one.is_accepted && one.score >= min_score - 1e-9) ++sum;
      }
      return sum;
    };
    std::int64_t least = cost(0);
    for (int part = 0; part <= 100; ++part) {
      std::int64_t rejected = 0;
      for (const DecidedScore& one : decisions) rejected += !one.is_accepted && one.score < 0.01 * part - 1e-9 ? 1 : 0;
      if (rejected >= kMinRejectedBelow) least = std::min(least, cost(0.01 * part));
    }
    const auto found = LearnThreshold(decisions);
    EXPECT_EQ(cost(found ? found->min_score : 0), least) << "round " << round;
  }
}

}  // namespace
}  // namespace victorious
