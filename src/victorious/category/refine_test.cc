#include "victorious/category/refine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"
#include "victorious/category/category_file.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

// A model trained on few images, of low accuracy.
CategoryModel RawModel() { return *TrainCategories(testing::DrawExamples(3, 1), testing::SmallOptions()); }

double RefinedAccuracy(const CategoryModel& model, std::span<const CategoryExample> examples) {
  double right = 0;
  for (const CategoryExample& example : examples) {
    const auto result = Classify(model, QuantiseFeatures(model, example.features), CategoryMethod::kPhrases);
    right += model.nodes[result.label].name == example.category ? 1 : 0;
  }
  return right / static_cast<double>(examples.size());
}

// The same two shapes with inverted contrast: bright discs, dark crosses.
std::vector<CategoryExample> DrawNegatives(int images_each, std::uint64_t seed) {
  Random random(seed);
  std::vector<CategoryExample> examples;
  for (int i = 0; i < 2 * images_each; ++i) {
    const cv::Mat negative = 255 - testing::DrawPair(i % 2 == 0, random);
    examples.push_back({.category = i % 2 == 0 ? "cross-disc" : "disc-cross",
                        .features = DenseFeatures(negative, testing::CoarseGrid()),
                        .image = i});
  }
  return examples;
}

TEST(RefineCategories, LearnsFromMarkedResults) {
  const CategoryModel model = RawModel();
  std::vector<CategoryFeedback> marks;
  for (const CategoryExample& example : DrawNegatives(10, 5))
    marks.push_back({.category = example.category, .right = true, .features = example.features});
  const auto refined = RefineCategories(model, marks);
  ASSERT_TRUE(refined.has_value()) << refined.error().message;
  const auto negatives = DrawNegatives(15, 7);
  EXPECT_GT(RefinedAccuracy(*refined, negatives), RefinedAccuracy(model, negatives) + 0.15);
}

TEST(RefineCategories, MarkedFalsePositiveScoresLower) {
  const CategoryModel model = RawModel();
  const auto example = testing::DrawExamples(1, 11)[0];
  const auto score = [&](const CategoryModel& of) {
    return Classify(of, QuantiseFeatures(of, example.features), CategoryMethod::kPhrases).scores[1].raw;
  };
  const CategoryFeedback mark{.category = model.nodes[1].name, .right = false, .features = example.features};
  EXPECT_LT(score(*RefineCategories(model, std::span(&mark, 1))), score(model));
}

TEST(CountAgreeing, RisesByRefinement) {
  const CategoryModel model = RawModel();
  std::vector<CategoryFeedback> marks;
  for (const CategoryExample& example : DrawNegatives(10, 5)) {
    marks.push_back({.category = example.category, .right = true, .features = example.features});
  }
  const std::size_t before = CountAgreeing(model, marks);
  EXPECT_GT(CountAgreeing(*RefineCategories(model, marks), marks), before);
  for (CategoryFeedback& mark : marks) mark.right = false;
  EXPECT_EQ(CountAgreeing(model, marks), marks.size() - before) << "each mark agrees as right or as wrong";
  for (CategoryFeedback& mark : marks) mark.category = "boat";
  EXPECT_EQ(CountAgreeing(model, marks), marks.size());
  EXPECT_EQ(CountAgreeing(model, {}), 0U);
}

TEST(RefineCategories, WithoutMarksChangesNothing) {
  const CategoryModel model = RawModel();
  EXPECT_EQ(EncodeCategoryModel(*RefineCategories(model, {})), EncodeCategoryModel(model));
}

TEST(RefineCategories, RefusesUnknownCategoriesAndThesisModels) {
  const CategoryFeedback mark{.category = "boat", .right = true, .features = {}};
  EXPECT_THAT(RefineCategories(RawModel(), std::span(&mark, 1)).error().message, HasSubstr("boat"));
  const auto thesis = TrainCategories(testing::DrawExamples(3, 1), testing::SmallOptions(CategoryScoring::kLikelihood));
  EXPECT_THAT(RefineCategories(*thesis, {}).error().message, HasSubstr("train it again"));
}

}  // namespace
}  // namespace victorious
