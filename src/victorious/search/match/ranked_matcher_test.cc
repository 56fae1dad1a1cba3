#include "victorious/search/match/ranked_matcher.h"

#include <vector>

#include <gtest/gtest.h>

#include "testing/processor_device.h"
#include "victorious/base/random.h"

namespace victorious {
namespace {

FeatureSet RandomRankedFeatures(Random& random, std::size_t count) {
  FeatureSet features;
  features.keypoints.resize(count);
  features.descriptors.resize(count * kDescriptorSize);
  for (std::uint8_t& byte : features.descriptors) byte = static_cast<std::uint8_t>(random.Below(256));
  return features;
}

TEST(RankedMatcher, RanksTheNearestFirstWithoutRatioTest) {
  Random random(3);
  FeatureSet scene = RandomRankedFeatures(random, 60);
  const FeatureSet model = RandomRankedFeatures(random, 2);
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
  const FeatureSet scene = RandomRankedFeatures(random, 4);
  const FeatureSet model = RandomRankedFeatures(random, 5);
  EXPECT_TRUE(RankedMatcher(scene.View()).Match(kernels::PackQueries(model.descriptors), 4).empty());
  EXPECT_TRUE(RankedMatcher(FeatureSet().View()).Match(kernels::PackQueries(model.descriptors), 1).empty());
}

TEST(RankedMatcher, MatchesAllTemplatesAsEachAlone) {
  Random random(5);
  const FeatureSet scene = RandomRankedFeatures(random, 100);
  std::vector<kernels::PackedQueries> templates;
  for (const std::size_t count : {7, 0, 20}) {
    templates.push_back(kernels::PackQueries(RandomRankedFeatures(random, count).descriptors));
  }
  const RankedMatcher matcher(scene.View());
  std::vector<std::vector<RankedMatch>> expected;
  for (const kernels::PackedQueries& one : templates) expected.push_back(matcher.Match(one, 4));
  EXPECT_EQ(matcher.MatchAll(templates, 4), expected);
  testing::ProcessorDevice device;
  EXPECT_EQ(RankedMatcher(scene.View(), &device).MatchAll(templates, 4), expected);
  EXPECT_EQ(device.query_count(), 27U);
  using enum testing::ProcessorDevice::Failing;
  for (const auto failing : {kSets, kQueries, kSearches}) {
    testing::ProcessorDevice broken(failing);
    EXPECT_EQ(RankedMatcher(scene.View(), &broken).MatchAll(templates, 4), expected);
    EXPECT_EQ(broken.failed_calls(), 1U);
  }
  EXPECT_EQ(RankedMatcher(FeatureSet().View(), &device).MatchAll(templates, 4),
            std::vector<std::vector<RankedMatch>>(3));
}

}  // namespace
}  // namespace victorious
