#include "victorious/category/explanation.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

TEST(ComputeContributions, SumToThePhraseScore) {
  const auto model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions());
  ASSERT_TRUE(model.has_value());
  const auto examples = testing::DrawExamples(1, 9);
  const QuantisedImage image = QuantiseFeatures(*model, examples[0].features);
  const auto evidence = ComputeContributions(*model, image, 0);
  ASSERT_FALSE(evidence.empty());
  EXPECT_TRUE(std::ranges::is_sorted(evidence, std::ranges::greater(), &PhraseContribution::weight));
  double sum = 0;
  for (const PhraseContribution& one : evidence) sum += one.weight;
  const LinearWeights& weights = model->linear()->phrase_weights[0];
  double rest = weights.offset + weights.fisher.dot(image.fisher);
  for (const auto& [word, value] : Hellinger(CountWords(image, model->vocabulary.size())))
    rest += static_cast<double>(weights.words(word)) * value;
  EXPECT_NEAR(sum + rest, Classify(*model, image, CategoryMethod::kPhrases).scores[0].raw, 1e-4);
}

TEST(SupportingBox, EnclosesContributingPhrases) {
  QuantisedImage image{.width = 320, .height = 160};
  std::vector<PhraseContribution> evidence;
  for (int x = 5; x < 320; x += 10)
    for (int y = 5; y < 160; y += 10) image.keypoints.push_back({static_cast<float>(x), static_cast<float>(y), 2, 0});
  for (std::uint32_t i = 0; i < image.size(); ++i) {
    const Keypoint& k = image.keypoints[i];
    const bool inside = k.x > 100 && k.x < 200 && k.y > 40 && k.y < 120;
    evidence.push_back({i, i, inside ? 1.0 : -0.1});
  }
  const Box box = SupportingBox(evidence, image);
  EXPECT_GT(IntersectionOverUnion(box, {100, 40, 100, 80}), 0.9);
  EXPECT_EQ(SupportingBox({}, image), (Box{0, 0, 320, 160}));
}

TEST(DrawContributions, WorksForBothScorings) {
  Random random(4);
  const cv::Mat grey = testing::DrawPair(true, random);
  cv::Mat bgr;
  cv::cvtColor(grey, bgr, cv::COLOR_GRAY2BGR);
  for (const CategoryScoring scoring : {CategoryScoring::kLinear, CategoryScoring::kLikelihood}) {
    const auto model = TrainCategories(testing::DrawExamples(4, 1), testing::SmallOptions(scoring));
    ASSERT_TRUE(model.has_value());
    const QuantisedImage image = QuantiseFeatures(*model, DenseFeatures(grey, testing::CoarseGrid()));
    const auto evidence = ComputeContributions(*model, image, 0);
    EXPECT_FALSE(evidence.empty());
    const cv::Mat drawn = DrawContributions(bgr, image, evidence, "caption");
    EXPECT_GE(drawn.cols, 480);
  }
  const QuantisedImage nothing{.width = 160, .height = 120};
  EXPECT_FALSE(DrawContributions(bgr, nothing, {}, "").empty());
}

}  // namespace
}  // namespace victorious
