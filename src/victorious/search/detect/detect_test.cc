#include "victorious/search/detect/detect.h"

#include <cmath>

#include <gtest/gtest.h>

namespace victorious {
namespace {

constexpr SceneSize kScene{640, 480};

Candidate CandidateAt(double x, double y, std::size_t agreeing, std::size_t model = 0) {
  Candidate candidate{.model_index = model, .view = 0, .matches = 80, .outline = BoxCorners({0, 0, 60, 40}), .fit = {}};
  candidate.fit.scene_from_template = {1.0, 0.0, {x, y}};
  candidate.fit.scene_from_template_plane = candidate.fit.scene_from_template.Matrix();
  candidate.fit.distinct_inliers = agreeing;
  candidate.fit.sigma_px = 3;
  candidate.fit.agreeing_residuals_px.assign(agreeing, 5.0);
  candidate.fit.extent = 0.4;
  return candidate;
}

TEST(ComputeNegLog10Nfa, IsTheBinomialTail) {
  // By direct summation in double.
  const double chance = 0.01;
  double tail = 0;
  for (int i = 6; i <= 48; ++i) {
    tail += std::exp(std::lgamma(49) - std::lgamma(i + 1) - std::lgamma(49 - i)) * std::pow(chance, i) *
            std::pow(1 - chance, 48 - i);
  }
  const double expected = 10 * (50 * 49 / 2) * tail;
  EXPECT_NEAR(ComputeNegLog10Nfa(50, 8, chance, 10), -std::log10(expected), 0.02);
}

TEST(ComputeNegLog10Nfa, GrowsWithAgreementAndFallsWithClutter) {
  EXPECT_GT(ComputeNegLog10Nfa(80, 8, 1e-3, 1), ComputeNegLog10Nfa(80, 7, 1e-3, 1));
  EXPECT_GT(ComputeNegLog10Nfa(80, 8, 1e-3, 1), ComputeNegLog10Nfa(200, 8, 1e-3, 1));
  EXPECT_NEAR(ComputeNegLog10Nfa(80, 8, 1e-3, 1) - ComputeNegLog10Nfa(80, 8, 1e-3, 1000), 3, 1e-9);
  EXPECT_EQ(ComputeNegLog10Nfa(80, 2, 1e-3, 1), 0);
  EXPECT_EQ(ComputeNegLog10Nfa(2, 8, 1e-3, 1), 0);
  EXPECT_EQ(ComputeNegLog10Nfa(1000, 10, 0.5, 1), 0);
}

// What chance makes in one frame of ten is likelier false, and what it makes in one of ten thousand is as likely true
// as a detection must be.
TEST(ComputeScore, IsTheProbabilityThatADetectionIsRight) {
  EXPECT_LT(ComputeScore(1), 0.35);
  EXPECT_NEAR(ComputeScore(4), DetectOptions().min_score, 0.05);
  EXPECT_GT(ComputeScore(8), 0.98);
  for (const double score : {0.1, 0.5, 0.795, 0.999}) EXPECT_NEAR(ComputeScore(NegLog10NfaOf(score)), score, 1e-9);
}

TEST(Detect, SuppressesNeighboursAndKeepsEveryInstance) {
  const std::vector<Candidate> candidates = {CandidateAt(100, 100, 9), CandidateAt(104, 98, 14),
                                             CandidateAt(300, 200, 10), CandidateAt(100, 100, 8, /*model=*/1)};
  const std::vector<Detection> detections = Detect(candidates, kScene, {});
  ASSERT_EQ(detections.size(), 3U);
  EXPECT_EQ(detections[0].fit.distinct_inliers, 14U);
  EXPECT_EQ(detections[1].fit.distinct_inliers, 10U);
  EXPECT_EQ(detections[2].model_index, 1U);
}

TEST(Detect, NfaOfTheMethodDoesNotAffectOtherModels) {
  const auto with_evidence = [](double x, std::size_t agreeing, double neg_log10_nfa) {
    Candidate candidate = CandidateAt(x, 100, agreeing, /*model=*/1);
    candidate.fit.neg_log10_nfa = neg_log10_nfa;
    return candidate;
  };
  // One instance of model 1: the lower NFA wins, although that pose has fewer inliers.
  const std::vector<Candidate> candidates = {with_evidence(100, 3, 10), CandidateAt(300, 100, 9),
                                             with_evidence(104, 9, 5), CandidateAt(303, 100, 14)};
  const std::vector<Detection> detections = Detect(candidates, kScene, {});
  ASSERT_EQ(detections.size(), 2U);
  for (const Detection& found : detections) EXPECT_EQ(found.fit.distinct_inliers, found.model_index == 1 ? 3U : 14U);
}

TEST(Detect, TwoViewsOfALongObjectAreOneDetection) {
  Candidate along = CandidateAt(100, 100, 14);
  along.outline = BoxCorners({0, 0, 240, 40});
  Candidate shifted = along;
  shifted.fit.scene_from_template.translation = {190, 105};
  shifted.fit.scene_from_template_plane = shifted.fit.scene_from_template.Matrix();
  shifted.fit.distinct_inliers = 9;
  shifted.fit.agreeing_residuals_px.assign(9, 5.0);
  const std::vector<Candidate> one = {along, shifted};
  EXPECT_EQ(Detect(one, kScene, {}).size(), 1U);
  Candidate beside = along;  // parked alongside
  beside.fit.scene_from_template.translation = {100, 142};
  beside.fit.scene_from_template_plane = beside.fit.scene_from_template.Matrix();
  const std::vector<Candidate> two = {along, beside};
  EXPECT_EQ(Detect(two, kScene, {.suppression_fraction = 0.1}).size(), 2U);
}

TEST(Detect, BoxIsTheOutlineClippedToTheFrame) {
  const std::vector<Candidate> candidates = {CandidateAt(-20, 450, 12)};
  const std::vector<Detection> detections = Detect(candidates, kScene, {.min_in_view = 0.49});
  EXPECT_TRUE(Detect(candidates, kScene, {.min_in_view = 0.51}).empty());
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].box, (Box{0, 450, 40, 30}));
  EXPECT_EQ(detections[0].outline[0], Eigen::Vector2d(-20, 450));
}

TEST(Detect, SmallerResidualsRaiseNegLog10Nfa) {
  Candidate loose = CandidateAt(100, 100, 9);
  loose.fit.agreeing_residuals_px.assign(9, 12.0);
  Candidate close = loose;
  close.fit.agreeing_residuals_px.assign(9, 1.0);
  Candidate partly = loose;  // six as closely, three far off
  partly.fit.agreeing_residuals_px = {1, 1, 1, 1, 1, 1, 40, 40, 40};
  Candidate six = loose;
  six.fit.agreeing_residuals_px.assign(6, 1.0);
  const auto neg_log10_nfa = [](const Candidate& one) {
    return Detect(std::span(&one, 1), kScene, {.min_score = 0})[0].neg_log10_nfa;
  };
  EXPECT_GT(neg_log10_nfa(close), neg_log10_nfa(loose) + 3);
  EXPECT_NEAR(neg_log10_nfa(partly), neg_log10_nfa(six), 0.5) << "distant ones have no influence";
}

// The NFA of the close matches decides, not the total number of inliers.
TEST(Detect, KeepsFitWithHigherNegLog10Nfa) {
  Candidate many = CandidateAt(100, 100, 12);
  many.fit.agreeing_residuals_px.assign(6, 5.0);
  const Candidate agreed = CandidateAt(104, 98, 10);
  const std::vector<Candidate> both = {many, agreed};
  const std::vector<Detection> detections = Detect(both, kScene, {});
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].fit.distinct_inliers, 10U);
}

TEST(Detect, SmallerSearchRegionLowersNegLog10Nfa) {
  const Candidate candidate = CandidateAt(100, 100, 8);
  SceneSize part = kScene;
  part.searched_px2 = 100 * 80;
  const double whole = Detect(std::span(&candidate, 1), kScene, {.min_score = 0})[0].neg_log10_nfa;
  EXPECT_LT(Detect(std::span(&candidate, 1), part, {.min_score = 0})[0].neg_log10_nfa, whole - 5);
}

TEST(Detect, InliersInOneCornerAreNoDetection) {
  Candidate corner = CandidateAt(100, 100, 12);
  corner.fit.extent = 0.02;
  EXPECT_TRUE(Detect(std::span(&corner, 1), kScene, {}).empty());
  EXPECT_EQ(Detect(std::span(&corner, 1), kScene, {.min_extent = 0.01}).size(), 1U);
}

TEST(Detect, WeakOrInvisibleCandidatesAreNoDetections) {
  const std::vector<Candidate> weak = {CandidateAt(100, 100, 4)};
  EXPECT_TRUE(Detect(weak, kScene, {}).empty());
  const std::vector<Candidate> outside = {CandidateAt(700, 100, 20)};
  EXPECT_TRUE(Detect(outside, kScene, {}).empty());
  EXPECT_TRUE(Detect({}, kScene, {}).empty());
}

TEST(Detect, MinScoreIsTheScoreThatADetectionNeeds) {
  const Candidate weak = CandidateAt(100, 100, 4);
  EXPECT_TRUE(Detect(std::span(&weak, 1), kScene, {}).empty());
  const std::vector<Detection> found = Detect(std::span(&weak, 1), kScene, {.min_score = 0});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(Detect(std::span(&weak, 1), kScene, {.min_score = found[0].score - 1e-6}).size(), 1U);
  EXPECT_TRUE(Detect(std::span(&weak, 1), kScene, {.min_score = found[0].score + 1e-6}).empty());
}

TEST(Detect, MinSideIsThatOfTheBoxInTheFrame) {
  const Candidate candidate = CandidateAt(100, 100, 12);  // 60 x 40 px
  EXPECT_EQ(Detect(std::span(&candidate, 1), kScene, {.min_side_px = 39}).size(), 1U);
  EXPECT_TRUE(Detect(std::span(&candidate, 1), kScene, {.min_side_px = 41}).empty());
}

}  // namespace
}  // namespace victorious
