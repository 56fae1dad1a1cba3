#include "victorious/category/finder/category_finder.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CategoryModel SmallModel() {
  CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions()).value();
  CategoryFeatureOptions features;
  features.dense = testing::CoarseGrid();
  model.features_json = OptionsToJsonText(features);
  return model;
}

// The bounding box of the pixels that are much brighter or darker than the noise.
Box BoxOfObjects(const cv::Mat& grey) {
  const cv::Rect rect = cv::boundingRect((grey < 60) | (grey > 150));
  return {static_cast<double>(rect.x), static_cast<double>(rect.y), static_cast<double>(rect.width),
          static_cast<double>(rect.height)};
}

TEST(CategoryFinder, FindsTheCategoryAtItsPosition) {
  const auto finder = CategoryFinder::Create(SmallModel(), {});
  ASSERT_TRUE(finder) << finder.error().message;
  EXPECT_THAT(finder->names(), ElementsAre("cross-disc", "disc-cross"));
  Random random(9);
  int right = 0;
  int near = 0;
  constexpr int kImages = 20;
  for (int i = 0; i < kImages; ++i) {
    const cv::Mat grey = testing::DrawPair(i % 2 == 0, random);
    const auto found = finder->Find(grey);
    ASSERT_TRUE(found);
    for (const FoundCategory& one : *found) {
      EXPECT_GE(one.probability, 0.5);
      if (one.category != static_cast<std::size_t>(i % 2)) continue;
      ++right;
      near += IntersectionOverUnion(one.box, BoxOfObjects(grey)) > 0.25 ? 1 : 0;
    }
  }
  EXPECT_GE(right, kImages - 2);
  EXPECT_GE(near, right * 3 / 4);
}

TEST(CategoryFinder, BackgroundCategoryIsNotReported) {
  const auto finder = CategoryFinder::Create(SmallModel(), {.min_probability = 0, .background = "boat, disc-cross"});
  ASSERT_TRUE(finder) << finder.error().message;
  EXPECT_THAT(finder->names(), ElementsAre("cross-disc"));
  Random random(2);
  const auto found = finder->Find(testing::DrawPair(false, random));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1);
  EXPECT_EQ(found->at(0).category, 0);
}

TEST(CategoryFinder, UniformImageHasNone) {
  const auto finder = CategoryFinder::Create(SmallModel(), {.min_probability = 0});
  ASSERT_TRUE(finder);
  const auto found = finder->Find(cv::Mat(120, 160, CV_8UC1, cv::Scalar(128)));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->empty());
}

TEST(CategoryFinder, IdDependsOnTheModel) {
  CategoryModel other = SmallModel();
  std::get<LinearModel>(other.classifier).phrase_weights[0].offset += 1;
  const auto first = CategoryFinder::Create(SmallModel(), {});
  const auto same = CategoryFinder::Create(SmallModel(), {});
  const auto second = CategoryFinder::Create(std::move(other), {});
  ASSERT_TRUE(first && same && second);
  EXPECT_EQ(first->content_id(), same->content_id());
  EXPECT_NE(first->content_id(), second->content_id());
}

TEST(CategoryFinder, RefusesModelsWithoutCategories) {
  const auto finder = CategoryFinder::Create(SmallModel(), {.background = "cross-disc,disc-cross"});
  ASSERT_FALSE(finder);
  EXPECT_EQ(finder.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(finder.error().message, HasSubstr("cross-disc,disc-cross"));
}

TEST(CategoryFinder, MinProbabilityIsTheProbabilityThatASightingNeeds) {
  Random random(9);
  const cv::Mat grey = testing::DrawPair(true, random);
  const auto find = [&](double min_probability) {
    return CategoryFinder::Create(SmallModel(), {.min_probability = min_probability}).value().Find(grey).value();
  };
  const std::vector<FoundCategory> all = find(0);
  ASSERT_FALSE(all.empty());
  const double highest = std::ranges::max(all, {}, &FoundCategory::probability).probability;
  EXPECT_EQ(find(highest - 1e-6).size(), 1U);
  EXPECT_TRUE(find(highest + 1e-6).empty());
}

}  // namespace
}  // namespace victorious
