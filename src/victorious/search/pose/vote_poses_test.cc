#include "victorious/search/pose/vote_poses.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/pose/random_keypoint_test.h"

namespace victorious {
namespace {

Keypoint Moved(const Keypoint& keypoint, const Similarity2& fit, Random& random) {
  const Eigen::Vector2d place = fit.Apply({keypoint.x, keypoint.y});
  const auto noise = [&](double most) { return most * (2 * random.Uniform() - 1); };
  return {static_cast<float>(place.x() + noise(1)), static_cast<float>(place.y() + noise(1)),
          static_cast<float>(keypoint.scale_px * fit.scale * std::exp(noise(0.15))),
          static_cast<float>(WrapAngle(keypoint.orientation_rad + fit.rotation_rad + noise(0.15)))};
}

// A template of 100 keypoints in a scene of 3000. `found` of them are in the scene at `pose`, at ranks 1 to 4; all
// other ranked matches are random.
struct VotedWorld {
  FeatureSet scene;
  std::vector<Keypoint> model;
  std::vector<RankedMatch> matches;
};

VotedWorld MakeVotedWorld(std::uint64_t seed, int found, const Similarity2& fit) {
  Random random(seed);
  VotedWorld world;
  world.scene.image_width = kWidth;
  world.scene.image_height = kHeight;
  for (int i = 0; i < 3000; ++i) world.scene.keypoints.push_back(RandomKeypoint(random, kWidth, kHeight));
  Random descriptors(seed + 1000);
  for (std::size_t i = 0; i < world.scene.keypoints.size() * kDescriptorSize; ++i) {
    world.scene.descriptors.push_back(static_cast<std::uint8_t>(descriptors.Below(90)));
  }
  for (std::uint32_t m = 0; m < 100; ++m) {
    world.model.push_back(RandomKeypoint(random, 200, 100));
    const std::uint32_t true_rank = m < static_cast<std::uint32_t>(found) ? 1 + random.Below(4) : 0;
    if (true_rank > 0) world.scene.keypoints[m] = Moved(world.model.back(), fit, random);
    for (std::uint32_t rank = 1; rank <= 4; ++rank) {
      world.matches.push_back({rank == true_rank ? m : 100 + random.Below(2900), m, rank});
    }
  }
  return world;
}

std::vector<PlanarFit> Find(const VotedWorld& world) {
  return VotePoses(world.scene, world.model, world.matches, kOutline, {}, {});
}

TEST(VotePoses, FindsPoseWithThreePercentInliers) {
  const Similarity2 truth{0.9, 1.1, {350, 200}};
  const VotedWorld world = MakeVotedWorld(1, 12, truth);
  const std::vector<PlanarFit> fits = Find(world);
  ASSERT_FALSE(fits.empty());
  const PlanarFit& fit = fits.front();
  EXPECT_NEAR(fit.scene_from_template.scale, truth.scale, 0.05);
  EXPECT_NEAR(fit.scene_from_template.rotation_rad, truth.rotation_rad, 0.05);
  EXPECT_LT((fit.scene_from_template.Apply({100, 50}) - truth.Apply({100, 50})).norm(), 5);
  EXPECT_GE(fit.distinct_inliers, 9U);
  EXPECT_GT(*fit.neg_log10_nfa, 4);
}

// Repeated texture, for example the joints of a pavement: false matches come together.
TEST(VotePoses, IdenticalDescriptorsAreNotSignificant) {
  VotedWorld world = MakeVotedWorld(1, 12, {0.9, 1.1, {350, 200}});
  const double neg_log10_nfa = *Find(world).front().neg_log10_nfa;
  EXPECT_GT(neg_log10_nfa, 4);
  for (std::size_t i = 0; i < 12 * kDescriptorSize; ++i) {
    world.scene.descriptors[i] = world.scene.descriptors[i % kDescriptorSize];
  }
  for (const PlanarFit& fit : Find(world)) EXPECT_LT(*fit.neg_log10_nfa, 0);
}

TEST(VotePoses, RandomMatchesAreNotSignificant) {
  const VoteOptions few_votes{.min_votes = 2};  // low, so that some votes agree by chance
  const PoseOptions few_inliers{.min_inliers = 2};
  std::size_t fits = 0;
  for (std::uint64_t seed = 10; seed < 30; ++seed) {
    const VotedWorld world = MakeVotedWorld(seed, 0, {});
    EXPECT_TRUE(Find(world).empty()) << seed;
    for (const PlanarFit& fit : VotePoses(world.scene, world.model, world.matches, kOutline, few_votes, few_inliers)) {
      EXPECT_LT(*fit.neg_log10_nfa, 0) << seed;
      ++fits;
    }
  }
  EXPECT_GT(fits, 10U);
}

// Many votes of few template keypoints give no pose.
TEST(VotePoses, VotesOfOneKeypointCountOnce) {
  const Similarity2 elsewhere{1.0, -2, {200, 300}};
  VotedWorld world = MakeVotedWorld(6, 0, {});
  Random random(7);
  for (std::size_t m = 50; m < 53; ++m) {
    for (std::size_t rank = 0; rank < 4; ++rank) {
      const std::size_t like = 4 * m + rank;  // index into the ranked matches and of a scene keypoint for each
      world.scene.keypoints[like] = Moved(world.model[m], elsewhere, random);
      world.matches[like].scene_keypoint = static_cast<std::uint32_t>(like);
    }
  }
  const VoteOptions three{.min_votes = 3};
  const PoseOptions few_inliers{.min_inliers = 3};
  const auto found = VotePoses(world.scene, world.model, world.matches, kOutline, three, few_inliers);
  ASSERT_FALSE(found.empty());
  EXPECT_LT((found[0].scene_from_template.Apply({100, 50}) - elsewhere.Apply({100, 50})).norm(), 20);
  const VoteOptions six{.min_votes = 6};
  for (const PlanarFit& fit : VotePoses(world.scene, world.model, world.matches, kOutline, six, few_inliers)) {
    EXPECT_GT((fit.scene_from_template.Apply({100, 50}) - elsewhere.Apply({100, 50})).norm(), 50);
  }
}

TEST(VotePoses, CoincidentInliersCountOnce) {
  const Similarity2 truth{1.0, 0, {200, 200}};
  VotedWorld world = MakeVotedWorld(2, 12, truth);
  const double before = *Find(world).front().neg_log10_nfa;
  // All twelve move to within two pixels of three points, in the template and in the scene.
  for (std::size_t i = 0; i < 12; ++i) {
    const auto spot = static_cast<float>(i % 3);
    const auto shift = 0.5F * static_cast<float>(i / 3);
    world.model[i].x = 40 + 60 * spot + shift;
    world.model[i].y = spot == 1 ? 80.0F : 20.0F;
    world.scene.keypoints[i].x = 200 + world.model[i].x;
    world.scene.keypoints[i].y = 200 + world.model[i].y;
  }
  const std::vector<PlanarFit> fits = Find(world);
  ASSERT_FALSE(fits.empty());
  EXPECT_GE(fits[0].distinct_inliers, 12U);
  for (const PlanarFit& fit : fits) EXPECT_LT(*fit.neg_log10_nfa, before - 4);
}

TEST(VotePoses, FindsTwoInstances) {
  VotedWorld world = MakeVotedWorld(3, 24, {0.8, 0.3, {50, 60}});
  const Similarity2 second{0.8, -2, {450, 350}};
  Random random(5);
  for (std::size_t i = 12; i < 24; ++i) world.scene.keypoints[i] = Moved(world.model[i], second, random);
  const std::vector<PlanarFit> fits = Find(world);
  ASSERT_GE(fits.size(), 2U);
  EXPECT_GT(*fits[1].neg_log10_nfa, 2);
  EXPECT_GT((fits[0].scene_from_template.Apply({100, 50}) - fits[1].scene_from_template.Apply({100, 50})).norm(), 100);
}

// A view from 40 degrees off nadir, in an image whose vertical is rotated by `turn_rad`, as the object is.
UprightPrior UprightAt(double turn_rad) {
  const double off_nadir_rad = RadiansFromDegrees(40);
  return UprightPrior::FromVertical(MakeVertical({0, off_nadir_rad - kPi / 2, -turn_rad}, 0.1, kWidth, kHeight),
                                    off_nadir_rad, RadiansFromDegrees(20));
}

TEST(VotePoses, KnownVerticalRaisesNegLog10NfaOfUprightPose) {
  const Similarity2 truth{0.9, 1.1, {350, 200}};
  const VotedWorld world = MakeVotedWorld(1, 12, truth);
  const auto fits = VotePoses(world.scene, world.model, world.matches, kOutline, {}, {}, UprightAt(1.1));
  ASSERT_FALSE(fits.empty());
  EXPECT_NEAR(fits[0].scene_from_template.rotation_rad, truth.rotation_rad, 0.05);
  EXPECT_GT(*fits[0].neg_log10_nfa, *Find(world)[0].neg_log10_nfa + 1);
}

TEST(VotePoses, RejectsTiltedPoses) {
  const VotedWorld world = MakeVotedWorld(1, 12, {0.9, 1.1, {350, 200}});
  ASSERT_GT(*Find(world)[0].neg_log10_nfa, 4);
  for (const PlanarFit& fit : VotePoses(world.scene, world.model, world.matches, kOutline, {}, {}, UprightAt(-0.6))) {
    EXPECT_LT(*fit.neg_log10_nfa, 1);
  }
}

TEST(VotePoses, EmptyInputGivesNoPose) {
  EXPECT_TRUE(VotePoses({}, {}, {}, kOutline, {}, {}).empty());
  const VotedWorld world = MakeVotedWorld(4, 12, {});
  EXPECT_TRUE(VotePoses(world.scene, world.model, world.matches, {}, {}, {}).empty());
}

}  // namespace
}  // namespace victorious
