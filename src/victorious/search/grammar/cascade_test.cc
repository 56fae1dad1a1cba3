#include "victorious/search/grammar/cascade.h"

#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/similarity.h"

namespace victorious {
namespace {

struct World {
  std::vector<Keypoint> scene;
  std::vector<Keypoint> model;
  MatchSet matches;
  std::size_t true_matches = 0;
};

// `object` keypoints of a template seen through a similarity with some noise, then `clutter` matches at random.
World MakeWorld(std::size_t object, std::size_t clutter, const Similarity2& scene_from_template, double noise,
                std::uint64_t seed) {
  Random random(seed);
  World world;
  const std::size_t model_size = std::max<std::size_t>(object, 40);
  for (std::size_t i = 0; i < model_size; ++i) {
    world.model.push_back({static_cast<float>(random.Uniform(0, 100)), static_cast<float>(random.Uniform(0, 80)),
                           static_cast<float>(std::exp(random.Uniform(0.4, 1.8))),
                           static_cast<float>(random.Uniform(-kPi, kPi))});
  }
  const auto add = [&](Keypoint keypoint, std::size_t model) {
    world.matches.push_back({static_cast<std::uint32_t>(world.scene.size()), static_cast<std::uint32_t>(model), 0.7F});
    world.scene.push_back(keypoint);
  };
  for (std::size_t i = 0; i < object; ++i) {
    const Keypoint& m = world.model[i];
    const Eigen::Vector2d place = scene_from_template.Apply({m.x, m.y});
    add({static_cast<float>(place.x() + noise * random.Normal()),
         static_cast<float>(place.y() + noise * random.Normal()),
         static_cast<float>(m.scale_px * scene_from_template.scale * std::exp(0.05 * noise * random.Normal())),
         static_cast<float>(
             WrapAngle(m.orientation_rad + scene_from_template.rotation_rad + 0.05 * noise * random.Normal()))},
        i);
  }
  world.true_matches = object;
  for (std::size_t i = 0; i < clutter; ++i) {
    add({static_cast<float>(random.Uniform(0, 640)), static_cast<float>(random.Uniform(0, 480)),
         static_cast<float>(std::exp(random.Uniform(0.4, 2.5))), static_cast<float>(random.Uniform(-kPi, kPi))},
        random.Below(static_cast<std::uint32_t>(model_size)));
  }
  return world;
}

bool Equal(const CascadeResult& a, const CascadeResult& b) {
  return a.first == b.first && a.second == b.second && a.third == b.third;
}

TEST(Cascade, MatchesTheDefinition) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    Similarity2 fit{
        std::exp(random.Uniform(-1, 1)), random.Uniform(-kPi, kPi), {random.Uniform(0, 500), random.Uniform(0, 400)}};
    World world = MakeWorld(random.Below(30), random.Below(150), fit, random.Uniform(0, 2), seed);
    // Some keypoints with two orientations, and some that lie at one position of the template.
    for (std::size_t i = 0; i + 7 < world.scene.size(); i += 7) {
      world.scene[i + 1].x = world.scene[i].x;
      world.scene[i + 1].y = world.scene[i].y;
    }
    CascadeOptions options;
    options.radius_px = std::exp(random.Uniform(0, 6));
    options.radius = random.Below(2) == 1 ? CascadeRadius::kScale : CascadeRadius::kFixed;
    options.radius_fraction = std::exp(random.Uniform(-2, 1));
    constexpr std::array kFilters = {CascadeFilter::kCascade, CascadeFilter::kCascade, CascadeFilter::kFirst,
                                     CascadeFilter::kSecond,  CascadeFilter::kThird,   CascadeFilter::kNone};
    options.filter = kFilters[random.Below(kFilters.size())];
    options.distinct_stages = static_cast<int>(random.Below(4));
    options.all_measures = random.Below(2) == 1;
    options.min_votes = static_cast<int>(random.Below(4));
    EXPECT_TRUE(Equal(FilterByGrammar(world.scene, world.model, world.matches, options),
                      FilterByGrammarRef(world.scene, world.model, world.matches, options)))
        << "seed " << seed;
  }
}

TEST(Cascade, KeepsTrueAndRejectsFalseMatches) {
  int kept_true = 0;
  int kept_false = 0;
  int all_true = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Similarity2 fit{std::exp(random.Uniform(-0.5, 0.5)),
                          random.Uniform(-kPi, kPi),
                          {random.Uniform(150, 450), random.Uniform(150, 350)}};
    const World world = MakeWorld(15, 70, fit, 0.5, seed);
    all_true += 15;
    for (const Match& match : FilterByGrammar(world.scene, world.model, world.matches, {}).third) {
      (match.scene_keypoint < world.true_matches ? kept_true : kept_false) += 1;
    }
  }
  EXPECT_GE(kept_true, 0.98 * all_true);
  EXPECT_LE(kept_false, 0.01 * (kept_true + kept_false));
}

// The measures are relative: the result is invariant to translation, rotation and (with R) scale of the scene.
TEST(Cascade, IsInvariantUnderSimilaritiesOfTheScene) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const World world = MakeWorld(20, 100, {1.0, 0.3, {200, 200}}, 1.0, seed);
    const Similarity2 change{2.0, 2.5, {300, -120}};
    World changed = world;
    for (Keypoint& keypoint : changed.scene) {
      const Eigen::Vector2d place = change.Apply({keypoint.x, keypoint.y});
      keypoint = {static_cast<float>(place.x()), static_cast<float>(place.y()),
                  static_cast<float>(keypoint.scale_px * change.scale),
                  static_cast<float>(WrapAngle(keypoint.orientation_rad + change.rotation_rad))};
    }
    CascadeOptions options;
    const CascadeResult before = FilterByGrammar(world.scene, world.model, world.matches, options);
    options.radius_px *= change.scale;
    EXPECT_TRUE(Equal(before, FilterByGrammar(changed.scene, changed.model, changed.matches, options)))
        << "seed " << seed;
  }
}

// With R from the matches' scale no prior on the size is needed.
TEST(Cascade, RadiusFromScaleGrowsWithTheObject) {
  CascadeOptions options;
  options.radius = CascadeRadius::kScale;
  for (const double size : {0.25, 1.0, 6.0}) {
    const World world = MakeWorld(20, 60, {size, 0.3, {200, 200}}, 0.3, 7);
    std::size_t kept_true = 0;
    for (const Match& match : FilterByGrammar(world.scene, world.model, world.matches, options).third)
      kept_true += match.scene_keypoint < world.true_matches ? 1 : 0;
    EXPECT_GE(kept_true, 19U) << "size " << size;
  }
}

TEST(Cascade, EachFilterAppliesItsStages) {
  const World world = MakeWorld(15, 70, {1.0, 0.3, {200, 200}}, 0.5, 3);
  const auto with = [&](CascadeFilter filter) {
    CascadeOptions options;
    options.filter = filter;
    return FilterByGrammar(world.scene, world.model, world.matches, options);
  };
  EXPECT_EQ(with(CascadeFilter::kNone).third, world.matches);
  EXPECT_EQ(with(CascadeFilter::kFirst).third, with(CascadeFilter::kCascade).first);
  EXPECT_EQ(with(CascadeFilter::kThird).second, world.matches);
  EXPECT_EQ(with(CascadeFilter::kNeighbours).third, FilterByNeighbours(world.scene, world.model, world.matches, {}));
}

// Section 3.3.4: four scene keypoints that all match one template keypoint, beside a true group of four.
TEST(Cascade, DistinctSupportRejectsRepeatedPatterns) {
  World world = MakeWorld(4, 0, {1.0, 0.0, {100, 100}}, 0.0, 5);
  std::vector<std::uint32_t> windows;
  const Keypoint a = world.model[10];
  const Keypoint b = world.model[11];
  for (int i = 0; i < 4; ++i) {  // two template keypoints, each matched by a cluster of four
    for (const std::uint32_t m : {10U, 11U}) {
      const Keypoint& keypoint = m == 10 ? a : b;
      const auto jitter = static_cast<float>(i);
      world.matches.push_back({static_cast<std::uint32_t>(world.scene.size()), m, 0.7F});
      world.scene.push_back({keypoint.x + 400 + jitter, keypoint.y + 300, keypoint.scale_px, keypoint.orientation_rad});
    }
  }
  CascadeOptions options;
  options.third_approval = 0.3;
  options.first_approval = options.second_approval = 0.1;
  options.distinct_stages = 0;
  const MatchSet without = FilterByGrammar(world.scene, world.model, world.matches, options).third;
  options.distinct_stages = 1;
  const MatchSet with = FilterByGrammar(world.scene, world.model, world.matches, options).third;
  EXPECT_GT(without.size(), 4U);
  EXPECT_EQ(with.size(), 4U);
  for (const Match& match : with) EXPECT_LT(match.template_keypoint, 4U);
}

// Very many voters, all within R of each other.
TEST(Cascade, ManyVotersMatchTheDefinition) {
  const World world = MakeWorld(100, 4100, {1.0, 0.3, {200, 200}}, 1.0, 9);
  CascadeOptions options;
  options.radius_px = 2000;
  options.filter = CascadeFilter::kThird;
  options.distinct_stages = 1;
  EXPECT_TRUE(Equal(FilterByGrammar(world.scene, world.model, world.matches, options),
                    FilterByGrammarRef(world.scene, world.model, world.matches, options)));
}

TEST(Cascade, EmptyAndSingleMatchesGiveNoMatches) {
  World world = MakeWorld(1, 0, {1.0, 0.0, {0, 0}}, 0.0, 1);
  EXPECT_TRUE(FilterByGrammar(world.scene, world.model, world.matches, {}).third.empty());
  EXPECT_TRUE(FilterByGrammar(world.scene, world.model, {}, {}).third.empty());
}

// What each parameter changes, on six matches of one object without noise.
class CascadeParameter : public ::testing::Test {
 protected:
  static constexpr std::size_t kMatches = 6;

  [[nodiscard]] std::size_t CountKept(const CascadeOptions& options) const {
    return FilterByGrammar(world_.scene, world_.model, world_.matches, options).third.size();
  }

  World world_ = MakeWorld(kMatches, 0, {1.0, 0.3, {200, 200}}, 0.0, 11);
};

TEST_F(CascadeParameter, RadiusLimitsTheVoters) {
  EXPECT_EQ(CountKept({.radius_px = 200}), kMatches);
  EXPECT_EQ(CountKept({.radius_px = 1}), 0U) << "no other match is within R";
}

TEST_F(CascadeParameter, ScaleDistortionBoundsTheRatioOfScales) {
  world_.scene[0].scale_px *= 1.3F;
  EXPECT_EQ(CountKept({.radius_px = 200, .scale_distortion = 1.35}), kMatches);
  EXPECT_EQ(CountKept({.radius_px = 200, .scale_distortion = 1.25}), kMatches - 1);
}

TEST_F(CascadeParameter, DistanceDistortionBoundsTheRatioOfScaleToDistance) {
  for (Keypoint& keypoint : world_.scene) keypoint.scale_px *= 1.3F;  // the ratios of two scales stay
  EXPECT_EQ(CountKept({.radius_px = 200, .distance_distortion = 1.35}), kMatches);
  EXPECT_EQ(CountKept({.radius_px = 200, .distance_distortion = 1.25}), 0U);
}

TEST_F(CascadeParameter, OrientationDistortionBoundsTheDifferenceOfOrientations) {
  world_.scene[0].orientation_rad = static_cast<float>(WrapAngle(world_.scene[0].orientation_rad + 1.0));
  EXPECT_EQ(CountKept({.radius_px = 200, .orientation_distortion_rad = 1.1}), kMatches);
  EXPECT_EQ(CountKept({.radius_px = 200, .orientation_distortion_rad = 0.9}), kMatches - 1);
}

TEST_F(CascadeParameter, LineDistortionBoundsTheAngleToTheConnectingLine) {
  for (Keypoint& keypoint : world_.scene) {  // the differences of two orientations stay
    keypoint.orientation_rad = static_cast<float>(WrapAngle(keypoint.orientation_rad + 0.5));
  }
  EXPECT_EQ(CountKept({.radius_px = 200, .line_distortion_rad = 0.6}), kMatches);
  EXPECT_EQ(CountKept({.radius_px = 200, .line_distortion_rad = 0.4}), 0U);
}

// Two groups of three that contradict each other in all measures: two of five possible votes for each match.
TEST_F(CascadeParameter, EachApprovalIsTheFractionOfVotesThatItsStageNeeds) {
  for (std::size_t i = 0; i < kMatches / 2; ++i) {
    world_.scene[i].scale_px *= 4;
    world_.scene[i].orientation_rad = static_cast<float>(WrapAngle(world_.scene[i].orientation_rad + 2.0));
  }
  const CascadeOptions wide{.radius_px = 200, .distance_distortion = 100, .line_distortion_rad = 3.15};
  for (const auto& [filter, approval] : {std::pair{CascadeFilter::kFirst, &CascadeOptions::first_approval},
                                         std::pair{CascadeFilter::kSecond, &CascadeOptions::second_approval},
                                         std::pair{CascadeFilter::kThird, &CascadeOptions::third_approval}}) {
    CascadeOptions options = wide;
    options.filter = filter;
    options.*approval = 0.39;
    EXPECT_EQ(CountKept(options), kMatches) << ToText(kCascadeFilterTexts, filter);
    options.*approval = 0.41;
    EXPECT_EQ(CountKept(options), 0U) << ToText(kCascadeFilterTexts, filter);
  }
}

}  // namespace
}  // namespace victorious
