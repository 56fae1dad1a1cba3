#include "victorious/category/finder/window_training.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"
#include "victorious/category/finder/category_finder.h"
#include "victorious/category/finder/category_images.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

cv::Mat Noise(int width, int height, Random& random) {
  cv::Mat image(height, width, CV_8UC1);
  for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(95 + random.Below(20));
  for (int i = 0; i < 6; ++i) {  // clutter
    const cv::Point at(static_cast<int>(random.Below(static_cast<std::uint32_t>(width))),
                       static_cast<int>(random.Below(static_cast<std::uint32_t>(height))));
    cv::line(image, at, at + cv::Point(25, static_cast<int>(random.Below(30))), 60 + random.Below(130), 3);
  }
  return image;
}

// A cross, or a ring, of a size in px.
Box Draw(cv::Mat& image, bool cross, cv::Point middle, int size) {
  const int half = size / 2;
  if (cross) {
    cv::line(image, middle - cv::Point(half, half), middle + cv::Point(half, half), 230, size / 6);
    cv::line(image, middle - cv::Point(half, -half), middle + cv::Point(half, -half), 230, size / 6);
  } else {
    cv::circle(image, middle, half, 230, size / 6);
  }
  return {static_cast<double>(middle.x - half), static_cast<double>(middle.y - half), static_cast<double>(size),
          static_cast<double>(size)};
}

CategoryTrainOptions SmallWindows() {
  CategoryTrainOptions options;
  options.features.dense = {.step_px = 8, .sizes = 4};
  options.features.windows = {.enabled = true, .side_px = 64, .min_window_px = 48};
  options.examples = {.copies = 2, .background = 6, .hard_negatives = 3};
  options.category = testing::SmallOptions();
  options.category.linear.shapes = {.weight = 4, .dimensions = 24};
  return options;
}

std::vector<LabelledImage> MakeImages(int each, Random& random) {
  std::vector<LabelledImage> images;
  for (int i = 0; i < 2 * each; ++i) {
    LabelledImage& image =
        images.emplace_back(LabelledImage{i % 2 == 0 ? "cross" : "ring", Noise(160, 140, random), {}});
    const int size = 40 + static_cast<int>(random.Below(30));
    image.box = Draw(image.grey, i % 2 == 0, {60 + static_cast<int>(random.Below(40)), 70}, size);
  }
  for (int i = 0; i < each; ++i) images.push_back({"nothing", Noise(240, 200, random), {}});
  return images;
}

class WindowTrainingTest : public ::testing::Test {
 protected:
  static Expected<CategoryModel> Train(const std::vector<LabelledImage>& images) {
    const CategoryTrainOptions options = SmallWindows();
    return TrainOnWindows(CategoryFeaturizer::Create(options.features).value(), images, options);
  }
};

TEST_F(WindowTrainingTest, FindsSeveralSmallObjectsAndNoneInBackground) {
  Random random(3);
  const auto model = Train(MakeImages(14, random));
  ASSERT_TRUE(model) << model.error().message;
  const auto finder = CategoryFinder::Create(*model, {});
  ASSERT_TRUE(finder) << finder.error().message;
  EXPECT_THAT(finder->names(), ::testing::ElementsAre("cross", "ring"))
      << "the background category is not searched for";
  int found = 0;
  int false_finds = 0;
  constexpr int kFrames = 6;
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat frame = Noise(320, 240, random);
    const Box cross = Draw(frame, true, {80, 70 + 10 * i}, 44 + 4 * i);
    const Box ring = Draw(frame, false, {230, 160 - 10 * i}, 44 + 4 * i);
    const auto finds = finder->Find(frame);
    ASSERT_TRUE(finds);
    std::set<std::size_t> objects;
    for (const FoundCategory& one : *finds) {
      const Box& truth = one.category == 0 ? cross : ring;
      if (IntersectionOverUnion(one.box, truth) > 0.25) {
        objects.insert(one.category);
      } else {
        ++false_finds;
      }
    }
    found += static_cast<int>(objects.size());
  }
  EXPECT_GE(found, 2 * kFrames - 3);
  EXPECT_LE(false_finds, 3);
  int finds_in_nothing = 0;
  for (int i = 0; i < kFrames; ++i) finds_in_nothing += static_cast<int>(finder->Find(Noise(320, 240, random))->size());
  EXPECT_LE(finds_in_nothing, 2);
}

TEST_F(WindowTrainingTest, CategoryWithoutBoxesIsRefusedByName) {
  Random random(6);
  std::vector<LabelledImage> images = MakeImages(4, random);
  images.push_back({"sky", Noise(240, 200, random), {}});
  const auto model = Train(images);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(model.error().message, ::testing::HasSubstr("nothing and sky"));
}

TEST_F(WindowTrainingTest, ImageIsClassifiedByItsBestWindow) {
  Random random(4);
  const auto model = Train(MakeImages(10, random));
  ASSERT_TRUE(model) << model.error().message;
  const CategoryFeaturizer featurizer = CategoryFeaturizer::Of(*model).value();
  cv::Mat image = Noise(300, 200, random);
  const Box ring = Draw(image, false, {200, 90}, 50);
  const auto seen = ClassifyImage(featurizer, *model, image, CategoryMethod::kPhrases);
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_EQ(model->nodes[seen->result.label].name, "ring");
  EXPECT_GT(IntersectionOverUnion(seen->classified_box, ring), 0.25);
  const auto words = ClassifyImage(featurizer, *model, image, CategoryMethod::kWords);
  ASSERT_FALSE(words);
  EXPECT_THAT(words.error().message, HasSubstr("windows"));
}

TEST_F(WindowTrainingTest, RequiresBackgroundImages) {
  Random random(5);
  auto images = MakeImages(3, random);
  std::erase_if(images, [](const LabelledImage& image) { return !image.box; });
  const auto model = Train(images);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(model.error().message, HasSubstr("no boxes"));
}

TEST_F(WindowTrainingTest, RefusesKeypointFeatures) {
  CategoryFeatureOptions features = SmallWindows().features;
  features.kind = CategoryFeatureKind::kKeypoints;
  const auto featurizer = CategoryFeaturizer::Create(features);
  ASSERT_FALSE(featurizer);
  EXPECT_THAT(featurizer.error().message, HasSubstr("dense"));
}

}  // namespace
}  // namespace victorious
