#include "victorious/match/ranked_matcher.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

FeatureSet RandomFeatures(Random& random, std::size_t count) {
  FeatureSet features;
  features.keypoints.resize(count);
  features.descriptors.resize(count * kDescriptorSize);
  for (std::uint8_t& byte : features.descriptors) byte = static_cast<std::uint8_t>(random.Below(256));
  return features;
}

TEST(RankedMatcher, RanksTheNearestFirstWithoutRatioTest) {
  Random random(3);
  FeatureSet scene = RandomFeatures(random, 60);
  const FeatureSet model = RandomFeatures(random, 2);
  // Two scene keypoints are nearly equally near to the template's second keypoint: a ratio test rejects both.
  for (const std::size_t i : {std::size_t{20}, std::size_t{40}}) {
    for (std::size_t byte = 0; byte < kDescriptorSize; ++byte) {
      scene.descriptors[i * kDescriptorSize + byte] = model.descriptors[kDescriptorSize + byte];
    }
  }
  scene.descriptors[20 * kDescriptorSize] ^= 3;
  const std::vector<RankedMatch> matches =
      RankedMatcher(scene.View()).Match(kernels::PackQueries(model.descriptors), 2);
  ASSERT_EQ(matches.size(), 4U);
  EXPECT_EQ(matches[2].template_keypoint, 1U);
  EXPECT_EQ(matches[2].scene_keypoint, 40U);
  EXPECT_EQ(matches[2].rank, 1U);
  EXPECT_EQ(matches[3].scene_keypoint, 20U);
  EXPECT_EQ(matches[3].rank, 2U);
}

TEST(RankedMatcher, TooFewSceneKeypointsGiveNoMatches) {
  Random random(4);
  const FeatureSet scene = RandomFeatures(random, 4);
  const FeatureSet model = RandomFeatures(random, 5);
  EXPECT_TRUE(RankedMatcher(scene.View()).Match(kernels::PackQueries(model.descriptors), 4).empty());
  EXPECT_TRUE(RankedMatcher(FeatureSet().View()).Match(kernels::PackQueries(model.descriptors), 1).empty());
}

}  // namespace
}  // namespace victorious
