#include "victorious/search/pose/rank_nfa.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/pose/random_keypoint_test.h"

namespace victorious {
namespace {

constexpr double kSizePx = 140;
constexpr PoseWindow kWindow = {.radius_px = 6, .widest_px = 12};
const Similarity2 kPose{1.5, 0.4, {320, 100}};

// A template of 30 keypoints in a scene of 1000 keypoints, all matched at ranks 1 to 4. They are 15 px
// min_separation_scales, and `min_separation_scales` is small, so that none overlap.
struct RankedWorld {
  FeatureSet scene;
  std::vector<Keypoint> model;
  std::vector<RankedMatch> inliers;
  VoteOptions options = {.min_separation_scales = 0.5};

  void Add(const Keypoint& keypoint, std::uint32_t rank) {
    const Eigen::Vector2d place = kPose.Apply({keypoint.x, keypoint.y});
    const auto index = static_cast<std::uint32_t>(model.size());
    inliers.push_back({static_cast<std::uint32_t>(scene.keypoints.size()), index, rank});
    model.push_back(keypoint);
    scene.keypoints.push_back({static_cast<float>(place.x()), static_cast<float>(place.y()),
                               static_cast<float>(keypoint.scale_px * kPose.scale),
                               static_cast<float>(WrapAngle(keypoint.orientation_rad + kPose.rotation_rad))});
  }

  [[nodiscard]] double NegLog10Nfa(std::size_t first_inliers) const {
    return ComputeRankNegLog10Nfa(kPose, std::span(inliers).first(first_inliers), kWindow, kSizePx, scene, model,
                                  options);
  }
};

RankedWorld MakeRankedWorld(std::uint64_t seed) {
  Random random(seed);
  RankedWorld world;
  world.scene.image_width = kWidth;
  world.scene.image_height = kHeight;
  const auto angle = [&] { return static_cast<float>(random.Uniform(-kPi, kPi)); };
  const auto scale = [&] { return static_cast<float>(1.5 * std::exp2(2 * random.Uniform())); };
  for (int i = 0; i < 970; ++i) {
    world.scene.keypoints.push_back({static_cast<float>(random.Uniform(0, kWidth)),
                                     static_cast<float>(random.Uniform(0, kHeight)), scale(), angle()});
  }
  for (int i = 0; i < 30; ++i) {
    const auto x = static_cast<float>(4 + 15 * (i % 10));
    const auto y = static_cast<float>(4 + 15 * (i / 10));
    world.Add({x, y, scale(), angle()}, 1 + random.Below(4));
  }
  return world;
}

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

// T: positions one window min_separation_scales, times rotations and scales that move the rim by one window.
double PosesThatDiffer() {
  const double rim = 0.5 * kSizePx * kPose.scale / kWindow.radius_px;
  return kWidth * kHeight / (kPi * kWindow.radius_px * kWindow.radius_px) * (2 * kPi * rim) * (4 * std::log(2.0) * rim);
}

// The chance p of each of the first inliers, counted by brute force; ascending.
std::vector<double> ChancesOf(const RankedWorld& world, std::size_t first_inliers) {
  std::vector<double> chances;
  for (std::size_t i = 0; i < first_inliers; ++i) {
    const RankedMatch& match = world.inliers[i];
    const Keypoint& expected = world.scene.keypoints[match.scene_keypoint];  // equals the projection exactly
    int wide = 0;
    for (const Keypoint& other : world.scene.keypoints) {
      const bool near = std::hypot(other.x - expected.x, other.y - expected.y) <= 2 * kWindow.widest_px;
      const double ratio = other.scale_px / expected.scale_px;
      const bool sized = ratio <= kVoteScaleFactor && ratio >= 1 / kVoteScaleFactor;
      const double turn = std::abs(WrapAngle(other.orientation_rad - expected.orientation_rad));
      wide += near && sized && turn <= 2 * world.options.turn_rad ? 1 : 0;
    }
    const double narrower = 2 * kWindow.widest_px / kWindow.radius_px;
    const double share = std::max(0.1, wide / (2 * narrower * narrower)) / static_cast<double>(world.scene.size());
    chances.push_back(std::min(1.0, match.rank * share));
  }
  std::ranges::sort(chances);
  return chances;
}

TEST(ComputeRankNegLog10Nfa, MatchesEnumeration) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RankedWorld world = MakeRankedWorld(seed);
    for (const std::size_t found : {0U, 1U, 5U, 12U, 30U}) {
      const std::vector<double> chances = ChancesOf(world, found);
      double least = 1;
      for (std::size_t i = 0; i < found; ++i) {
        const auto k = static_cast<int>(i + 1);
        least = std::min(least, Binomial(30, k) * std::pow(chances[i], k));
      }
      const double expected = -std::log10(PosesThatDiffer() * least) - kDependenceDecades;
      EXPECT_NEAR(world.NegLog10Nfa(found), expected, 1e-4) << seed << ", " << found;
    }
  }
}

TEST(ComputeRankNegLog10Nfa, IsBoundedByTheBinomialTail) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RankedWorld world = MakeRankedWorld(seed);
    for (const std::size_t found : {1U, 5U, 12U, 30U}) {
      const std::vector<double> chances = ChancesOf(world, found);
      double rarest = 1;  // minimum over k of the probability that k or more of 30 have a chance of at most p_k
      for (int k = 1; k <= static_cast<int>(found); ++k) {
        const double p = chances[static_cast<std::size_t>(k - 1)];
        double tail = 0;
        for (int j = k; j <= 30; ++j) tail += Binomial(30, j) * std::pow(p, j) * std::pow(1 - p, 30 - j);
        rarest = std::min(rarest, tail);
      }
      const double most = -std::log10(PosesThatDiffer() * rarest) - kDependenceDecades;
      EXPECT_LE(world.NegLog10Nfa(found), most + 1e-4) << seed << ", " << found;
    }
  }
}

TEST(ComputeRankNegLog10Nfa, GrowsWithInliersAndFallsWithRanks) {
  RankedWorld world = MakeRankedWorld(6);
  double before = world.NegLog10Nfa(0);
  for (std::size_t found = 1; found <= 30; ++found) {
    const double now = world.NegLog10Nfa(found);
    EXPECT_GE(now, before - 1e-9) << found;
    before = now;
  }
  EXPECT_GT(before, world.NegLog10Nfa(0) + 20);
  for (std::size_t i = 0; i < 30; ++i) {
    world.inliers[i].rank += 2;
    const double now = world.NegLog10Nfa(30);
    EXPECT_LE(now, before + 1e-9) << i;
    before = now;
  }
}

TEST(ComputeRankNegLog10Nfa, VisibleMissesLowerTheSignificance) {
  RankedWorld world = MakeRankedWorld(7);
  const double before = world.NegLog10Nfa(10);
  const std::size_t found = world.inliers.size();
  for (int i = 0; i < 20; ++i) world.model.push_back({static_cast<float>(4 + 8 * i), 60, 3, 0});
  EXPECT_EQ(world.inliers.size(), found);
  EXPECT_LT(world.NegLog10Nfa(10), before - 1);
}

// An inlier whose projection is not visible still counts in n.
TEST(ComputeRankNegLog10Nfa, InvisibleInliersCountAsTrials) {
  RankedWorld unseen = MakeRankedWorld(8);
  // Ten keypoints have a scale of 0.75 px in the scene, below the minimum.
  for (std::size_t i = 0; i < 30; ++i) {
    unseen.model[i].scale_px = i < 10 ? 0.5F : 4.0F;
    unseen.scene.keypoints[unseen.inliers[i].scene_keypoint].scale_px = unseen.model[i].scale_px * 1.5F;
  }
  for (const std::size_t found : {0U, 10U, 20U, 30U}) {
    const std::vector<double> chances = ChancesOf(unseen, found);
    const int n = 20 + static_cast<int>(std::min<std::size_t>(found, 10));
    double least = 1;
    for (std::size_t i = 0; i < found; ++i) {
      const auto k = static_cast<int>(i + 1);
      ASSERT_LE(k, n);
      least = std::min(least, Binomial(n, k) * std::pow(chances[i], k));
    }
    const double expected = -std::log10(PosesThatDiffer() * least) - kDependenceDecades;
    EXPECT_NEAR(unseen.NegLog10Nfa(found), expected, 1e-4) << found;
  }
}

// Descriptors of a norm of about 512 whose pairs are `distance` apart.
void SetDescriptors(double distance, RankedWorld& world) {
  world.scene.descriptors.assign(world.scene.size() * kDescriptorSize, 0);
  for (std::size_t i = 0; i < world.inliers.size(); ++i) {
    const std::size_t first = world.inliers[i].scene_keypoint * kDescriptorSize;
    for (std::size_t k = 0; k < 64; ++k) world.scene.descriptors[first + k] = 60;
    world.scene.descriptors[first + 64 + i] = static_cast<std::uint8_t>(std::lround(distance / std::sqrt(2.0)));
  }
}

// The joints of a pavement look alike, 120 apart: whatever their number, they are one inlier. True matches are of
// different parts of an object.
TEST(ComputeRankNegLog10Nfa, ARepeatedTextureIsOneInlier) {
  RankedWorld world = MakeRankedWorld(10);
  SetDescriptors(120, world);
  EXPECT_LT(world.NegLog10Nfa(30), world.NegLog10Nfa(1) + 1);
  SetDescriptors(200, world);
  EXPECT_GT(world.NegLog10Nfa(30), world.NegLog10Nfa(1) + 20);
}

TEST(ComputeRankNegLog10Nfa, RotationWindowIsLimitedToTheCircle) {
  RankedWorld world = MakeRankedWorld(9);
  world.options.turn_rad = kPi;
  const double all_turns = world.NegLog10Nfa(10);
  world.options.turn_rad = 3.2;  // more than half a turn
  EXPECT_DOUBLE_EQ(world.NegLog10Nfa(10), all_turns);
  world.options.turn_rad = kPi / 2;  // the doubled counting window holds all orientations, the window itself half
  EXPECT_GT(world.NegLog10Nfa(10), all_turns + 1);
}

}  // namespace
}  // namespace victorious
