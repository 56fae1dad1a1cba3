#include "victorious/search/match/matcher.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

FeatureSet RandomFeatures(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  FeatureSet features;
  features.keypoints.resize(count);
  features.descriptors.resize(count * kDescriptorSize);
  for (std::uint8_t& byte : features.descriptors) byte = static_cast<std::uint8_t>(random.Below(256));
  return features;
}

void CopyDescriptor(const FeatureSet& from, std::size_t i, FeatureSet& to, std::size_t j) {
  std::ranges::copy(from.View().Descriptor(i),
                    to.descriptors.begin() + static_cast<std::ptrdiff_t>(j * kDescriptorSize));
}

std::vector<MatchSet> MatchOne(const FeatureSet& scene, const FeatureSet& model, double ratio) {
  const FeatureView view = model.View();
  return MatchFeatures(scene.View(), TemplateSet(std::span(&view, 1)), {.ratio = ratio});
}

TEST(Matcher, SeveralSceneKeypointsMayMatchOneTemplateKeypoint) {
  const FeatureSet model = RandomFeatures(20, 1);
  FeatureSet scene = RandomFeatures(30, 2);
  CopyDescriptor(model, 4, scene, 7);
  CopyDescriptor(model, 4, scene, 19);
  const std::vector<MatchSet> matches = MatchOne(scene, model, 0.5);
  EXPECT_EQ(matches[0], (MatchSet{{7, 4, 0.0F}, {19, 4, 0.0F}}));
}

TEST(Matcher, RatioTestIsStrictAndWithinTheTemplate) {
  FeatureSet model = RandomFeatures(20, 3);
  FeatureSet scene = RandomFeatures(1, 4);
  CopyDescriptor(scene, 0, model, 5);
  CopyDescriptor(scene, 0, model, 6);  // a duplicate in the template: the ratio is 1 and never passes
  EXPECT_TRUE(MatchOne(scene, model, 1.0)[0].empty());
  const FeatureSet other = RandomFeatures(20, 5);  // a duplicate in another template has no effect
  FeatureSet single = RandomFeatures(20, 6);
  CopyDescriptor(scene, 0, single, 9);
  const std::vector<FeatureView> templates = {model.View(), single.View(), other.View()};
  const std::vector<MatchSet> matches = MatchFeatures(scene.View(), TemplateSet(templates), {.ratio = 0.5});
  EXPECT_TRUE(matches[0].empty());
  EXPECT_EQ(matches[1], (MatchSet{{0, 9, 0.0F}}));
  EXPECT_TRUE(matches[2].empty());
}

TEST(Matcher, TooFewKeypointsGiveNoMatch) {
  const FeatureSet scene = RandomFeatures(3, 7);
  EXPECT_TRUE(MatchOne(scene, RandomFeatures(0, 8), 1.0)[0].empty());
  EXPECT_TRUE(MatchOne(scene, RandomFeatures(1, 8), 1.0)[0].empty());
  EXPECT_TRUE(MatchOne(RandomFeatures(0, 9), scene, 1.0)[0].empty());
}

TEST(Matcher, HigherRatioAddsMatches) {
  const FeatureSet scene = RandomFeatures(200, 10);
  const FeatureSet model = RandomFeatures(50, 11);
  MatchSet previous;
  for (const double ratio : {0.6, 0.9, 0.95, 0.99, 1.0}) {
    MatchSet matches = MatchOne(scene, model, ratio)[0];
    EXPECT_TRUE(std::ranges::includes(matches, previous, {}, &Match::scene_keypoint, &Match::scene_keypoint));
    previous = std::move(matches);
  }
  EXPECT_GT(previous.size(), 150U);
}

}  // namespace
}  // namespace victorious
