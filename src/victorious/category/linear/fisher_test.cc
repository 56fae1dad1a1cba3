#include "victorious/category/linear/fisher.h"

#include <cmath>

#include <gtest/gtest.h>

#include "testing/category_tools.h"
#include "victorious/base/random.h"

namespace victorious {
namespace {

constexpr FisherOptions kSmall{.components = 4, .dimensions = 6, .samples = 500, .iterations = 8};

FeatureSet RandomFeatures(std::uint64_t seed) {
  Random random(seed);
  return DenseFeatures(testing::DrawPair(true, random), testing::CoarseGrid());
}

FisherEncoder Learnt(const FisherOptions& options = kSmall) {
  const FeatureSet a = RandomFeatures(1);
  const FeatureSet b = RandomFeatures(2);
  const std::vector<const FeatureSet*> sets = {&a, &b};
  return FisherEncoder::Learn(sets, options, 7);
}

TEST(FisherEncoder, VectorsHaveUnitLengthAndAreDeterministic) {
  const FisherEncoder encoder = Learnt();
  ASSERT_EQ(encoder.size(), 2U * 4 * (6 + 2));
  const Eigen::VectorXf vector = encoder.Encode(RandomFeatures(3));
  EXPECT_NEAR(vector.norm(), 1, 1e-5);
  EXPECT_EQ(vector, Learnt().Encode(RandomFeatures(3)));
  EXPECT_NEAR(encoder.mixture_weight.sum(), 1, 1e-5);
  EXPECT_GT(encoder.deviation.minCoeff(), 0);
}

// Features of one of two clusters, with weak noise.
FeatureSet FeaturesOfCluster(bool first, std::uint64_t seed) {
  Random random(seed);
  FeatureSet features;
  features.image_width = features.image_height = 100;
  for (int i = 0; i < 40; ++i) {
    features.keypoints.push_back(
        {static_cast<float>(random.Uniform(0, 100)), static_cast<float>(random.Uniform(0, 100)), 2, 0});
    for (std::size_t k = 0; k < kDescriptorSize; ++k)
      features.descriptors.push_back(
          static_cast<std::uint8_t>((k < 64) == first ? 60 + random.Below(20) : random.Below(4)));
  }
  return features;
}

TEST(FisherEncoder, ClustersHaveTheirOwnComponents) {
  const FeatureSet a = FeaturesOfCluster(true, 1);
  const FeatureSet b = FeaturesOfCluster(false, 2);
  const std::vector<const FeatureSet*> sets = {&a, &b};
  const FisherEncoder encoder = FisherEncoder::Learn(
      sets, {.components = 2, .dimensions = 2, .append_position = false, .samples = 500, .iterations = 20}, 3);
  EXPECT_NEAR(encoder.mixture_weight(0), 0.5, 0.01);
  // The first principal axis (the last row) separates the clusters; its variance within a cluster is small.
  EXPECT_GT(std::abs(encoder.centre(1, 0) - encoder.centre(1, 1)), 10 * encoder.deviation.row(1).maxCoeff() / 3);
  const Eigen::VectorXf one = encoder.Encode(FeaturesOfCluster(true, 3));
  EXPECT_GT(one.dot(encoder.Encode(FeaturesOfCluster(true, 4))),
            one.dot(encoder.Encode(FeaturesOfCluster(false, 5))) + 0.3);
}

TEST(FisherEncoder, PositionsAreUsedOnlyIfEnabled) {
  FeatureSet moved = RandomFeatures(3);
  for (Keypoint& keypoint : moved.keypoints) keypoint.x = static_cast<float>(moved.image_width) - keypoint.x;
  EXPECT_GT((Learnt().Encode(moved) - Learnt().Encode(RandomFeatures(3))).norm(), 0.1);
  FisherOptions options = kSmall;
  options.append_position = false;
  EXPECT_EQ(Learnt(options).Encode(moved), Learnt(options).Encode(RandomFeatures(3)));
}

TEST(FisherEncoder, NoFeaturesGiveEmptyVector) {
  EXPECT_EQ(Learnt().Encode({}).norm(), 0);
  FisherOptions none = kSmall;
  none.components = 0;
  EXPECT_EQ(Learnt(none).size(), 0U);
  EXPECT_EQ(Learnt(none).Encode(RandomFeatures(1)).size(), 0);
}

TEST(FisherEncoder, FewFeaturesLimitTheComponents) {
  FeatureSet few = RandomFeatures(1);
  few.keypoints.resize(3);
  few.descriptors.resize(3 * kDescriptorSize);
  const FeatureSet* const set = &few;
  const FisherEncoder encoder = FisherEncoder::Learn(std::span(&set, 1), kSmall, 1);
  EXPECT_EQ(encoder.mixture_weight.size(), 3);
  EXPECT_TRUE(encoder.Encode(RandomFeatures(2)).allFinite());
}

}  // namespace
}  // namespace victorious
