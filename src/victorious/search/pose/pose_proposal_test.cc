#include "victorious/search/pose/pose_proposal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"
#include "victorious/search/pose/random_keypoint_test.h"

namespace victorious {
namespace {

struct ProposalWorld {
  FeatureSet scene;
  std::vector<Keypoint> model;
  std::vector<RankedMatch> matches;
};

// A template of 100 keypoints with two matches each; `found` of them are in the scene at `pose`.
ProposalWorld MakeProposalWorld(std::uint64_t seed, std::uint32_t found, const Similarity2& pose) {
  Random random(seed);
  ProposalWorld world;
  world.scene.image_width = kWidth;
  world.scene.image_height = kHeight;
  for (int i = 0; i < 3000; ++i) world.scene.keypoints.push_back(RandomKeypoint(random, kWidth, kHeight));
  const auto noise = [&](double most) { return most * (2 * random.Uniform() - 1); };
  for (std::uint32_t m = 0; m < 100; ++m) {
    const Keypoint keypoint = RandomKeypoint(random, 200, 100);
    world.model.push_back(keypoint);
    if (m < found) {
      const Eigen::Vector2d place = pose.Apply({keypoint.x, keypoint.y});
      world.scene.keypoints[m] = {
          static_cast<float>(place.x() + noise(1)), static_cast<float>(place.y() + noise(1)),
          static_cast<float>(keypoint.scale_px * pose.scale * std::exp(noise(0.15))),
          static_cast<float>(WrapAngle(keypoint.orientation_rad + pose.rotation_rad + noise(0.15)))};
    }
    const std::uint32_t true_rank = m < found ? 1 + random.Below(2) : 0;
    for (std::uint32_t rank = 1; rank <= 2; ++rank) {
      world.matches.push_back({rank == true_rank ? m : 100 + random.Below(2900), m, rank});
    }
  }
  return world;
}

std::optional<PoseProposal> Propose(const ProposalWorld& world) {
  return ProposePose(world.scene, KeypointDensity(world.scene), world.model, world.matches, kOutline, kPi);
}

TEST(ProposePose, FindsThePose) {
  for (const double rotation_rad : {1.1, 3.1, -3.1}) {  // also across pi
    const Similarity2 truth{0.9, rotation_rad, {350, 250}};
    const std::optional<PoseProposal> found = Propose(MakeProposalWorld(1, 12, truth));
    ASSERT_TRUE(found);
    EXPECT_LT((found->centre_px - truth.Apply({100, 50})).norm(), 5);
    EXPECT_NEAR(found->size_px, 0.9 * std::sqrt(200 * 100), 5);
    EXPECT_GT(found->neg_log10_nfa, 4);
  }
}

TEST(ProposePose, ChanceIsNotSignificant) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::optional<PoseProposal> found = Propose(MakeProposalWorld(seed, 0, {}));
    if (found) {
      EXPECT_LT(found->neg_log10_nfa, 3) << seed;
    }
  }
}

TEST(ProposePose, MoreInliersAreMoreSignificant) {
  const Similarity2 truth{1.1, -0.4, {200, 200}};
  const auto mean = [&](std::uint32_t found) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      sum += Propose(MakeProposalWorld(seed, found, truth))->neg_log10_nfa;
    return sum / 5;
  };
  EXPECT_GT(mean(24), mean(10) + 5);
}

// A match of each template keypoint with the same scene keypoint is one inlier.
TEST(ProposePose, CountsEachSceneKeypointOnce) {
  ProposalWorld world = MakeProposalWorld(3, 12, {0.9, 1.1, {350, 200}});
  for (std::uint32_t m = 1; m < 12; ++m) world.model[m] = world.model[0];
  for (RankedMatch& match : world.matches) {
    if (match.scene_keypoint < 12) match.scene_keypoint = 0;
  }
  const std::optional<PoseProposal> found = Propose(world);
  if (found) {
    EXPECT_LT(found->neg_log10_nfa, 2);
  }
}

// Repeated with the proposal's own ranks, the test gives its -log10 NFA; with higher ranks, or fewer inliers, less.
TEST(ProposePose, IsTestedAgainByOtherRanks) {
  const ProposalWorld world = MakeProposalWorld(5, 12, {0.9, 1.1, {350, 250}});
  const std::optional<PoseProposal> found = Propose(world);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(NegLog10NfaOfRanks(*found, world.scene, found->inliers, kPi), found->neg_log10_nfa);
  std::vector<RankedMatch> other = found->inliers;
  for (RankedMatch& inlier : other) inlier.rank *= 4;
  EXPECT_LT(NegLog10NfaOfRanks(*found, world.scene, other, kPi), found->neg_log10_nfa - 3);
  other = found->inliers;
  other.resize(4);
  EXPECT_LT(NegLog10NfaOfRanks(*found, world.scene, other, kPi), found->neg_log10_nfa);
  EXPECT_LT(NegLog10NfaOfRanks(*found, world.scene, {}, kPi), 0);
}

TEST(ProposePose, NoOutlineAndNoMatchesGiveNoPose) {
  ProposalWorld world = MakeProposalWorld(4, 12, {});
  EXPECT_FALSE(ProposePose(world.scene, KeypointDensity(world.scene), world.model, world.matches, {}, kPi));
  world.matches.clear();
  EXPECT_FALSE(Propose(world));
  EXPECT_FALSE(Propose(ProposalWorld{}));
}

TEST(KeypointDensity, IsRelativeToTheMean) {
  FeatureSet scene;
  scene.image_width = 64;
  scene.image_height = 32;
  scene.keypoints = {{1, 1, 1, 0}, {2, 2, 1, 0}, {3, 3, 1, 0}, {63, 31, 1, 0}};  // 8 cells of 16 px
  const KeypointDensity density(scene);
  EXPECT_DOUBLE_EQ(density.Around(4, 4, 2), 3 / 0.5);
  EXPECT_DOUBLE_EQ(density.Around(60, 28, 2), 1 / 0.5);
  EXPECT_DOUBLE_EQ(density.Around(40, 8, 2), 0);
  EXPECT_DOUBLE_EQ(density.Around(32, 16, 1000), 1);
  EXPECT_DOUBLE_EQ(density.Around(-500, 900, 1), 0);  // the nearest cell
}

}  // namespace
}  // namespace victorious
