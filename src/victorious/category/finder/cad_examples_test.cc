#include "victorious/category/finder/cad_examples.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/cad_tools.h"
#include "testing/category_tools.h"
#include "testing/data.h"
#include "victorious/category/finder/category_images.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

// Twice as long as wide and high, dark on top, light at its sides.
Mesh Block() {
  const Eigen::Vector3f light(0.8F, 0.8F, 0.8F);
  const Eigen::Vector3f dark(0.1F, 0.1F, 0.1F);
  return testing::Box({-2, -1, -1}, {2, 1, 1}, {light, light, light, light, dark, dark});
}

cv::Mat Plain(int level) { return {150, 200, CV_8UC1, cv::Scalar(level)}; }

TEST(RenderCadExamples, ObjectIsInItsBoxAndBackgroundUnchanged) {
  const std::vector<cv::Mat> backgrounds = {Plain(128)};
  const auto images = RenderCadExamples(Block(), "block", backgrounds, {.views = 12}, 1);
  ASSERT_TRUE(images) << images.error().message;
  ASSERT_EQ(images->size(), 12U);
  for (const LabelledImage& image : *images) {
    EXPECT_EQ(image.category, "block");
    ASSERT_TRUE(image.box);
    const cv::Rect changed = cv::boundingRect(cv::Mat(cv::abs(image.grey - 128) > 3));
    EXPECT_NEAR(changed.x, image.box->x, 2.5);
    EXPECT_NEAR(changed.y, image.box->y, 2.5);
    EXPECT_NEAR(changed.width, image.box->width, 4);
    EXPECT_NEAR(changed.height, image.box->height, 4);
    EXPECT_GT(std::max(image.box->width / 200, image.box->height / 150), 0.55);
  }
}

TEST(RenderCadExamples, AreDeterministicBySeed) {
  const std::vector<cv::Mat> backgrounds = {Plain(128), Plain(60)};
  const auto one = RenderCadExamples(Block(), "block", backgrounds, {.views = 3}, 1).value();
  const auto again = RenderCadExamples(Block(), "block", backgrounds, {.views = 3}, 1).value();
  const auto other = RenderCadExamples(Block(), "block", backgrounds, {.views = 3}, 2).value();
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(cv::norm(one[i].grey, again[i].grey), 0);
    EXPECT_GT(cv::norm(one[i].grey, other[i].grey), 0);
  }
}

TEST(RenderCadExamples, RefuseAnEmptyRangeOfViews) {
  const std::vector<cv::Mat> backgrounds = {Plain(128)};
  const auto images =
      RenderCadExamples(Block(), "block", backgrounds, {.min_off_nadir_deg = 80, .max_off_nadir_deg = 20}, 1);
  ASSERT_FALSE(images);
  EXPECT_THAT(images.error().message, HasSubstr("min_off_nadir_deg 80"));
}

// A folder with clutter images and a CAD file of a block.
class CadExampleTest : public ::testing::Test {
 protected:
  CadExampleTest() {
    const std::string glb = testing::GlbFrom(Block());
    std::ofstream(folder_ / "block.glb", std::ios::binary) << glb;
    Random random(4);
    for (int i = 0; i < 16; ++i) {
      cv::Mat image = Clutter(random);
      EXPECT_TRUE(WriteImage((folder_ / fmt::format("{}.png", i)).string(), image));
      rows_.push_back(
          {.image = fmt::format("{}.png", i), .category = "nothing", .box = {}, .mark = {}, .where = "row"});
    }
  }

  static cv::Mat Clutter(Random& random) {
    cv::Mat image(150, 200, CV_8UC3, cv::Scalar::all(100 + random.Below(50)));
    const auto point = [&] {
      return cv::Point(static_cast<int>(random.Below(200)), static_cast<int>(random.Below(150)));
    };
    for (int i = 0; i < 12; ++i)
      cv::circle(image, point(), 4 + static_cast<int>(random.Below(20)), cv::Scalar::all(40), 2);
    return image;
  }

  static CategoryTrainOptions Small() {
    CategoryTrainOptions options;
    options.features.dense = {.step_px = 8, .sizes = 4};
    options.category = testing::SmallOptions();
    options.cad.views = 16;
    return options;
  }

  [[nodiscard]] Expected<CategoryModel> Train() const {
    return TrainOnList(folder_, rows_, Small(), [](std::size_t) {});
  }

  void AddCad() {
    rows_.push_back({.image = "block.glb", .category = "block", .box = {}, .mark = {}, .where = "row 17"});
  }

  testing::ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
  std::vector<CategoryListRow> rows_;
};

TEST_F(CadExampleTest, RepresentsItsCategory) {
  AddCad();
  const Expected<CategoryModel> model = Train();
  ASSERT_TRUE(model) << model.error().message;
  const CategoryFeaturizer featurizer = CategoryFeaturizer::Of(*model).value();
  const auto label = [&](const cv::Mat& grey) {
    const CategoryResult result = ClassifyImage(featurizer, *model, grey, CategoryMethod::kPhrases).value().result;
    return model->nodes[result.label].name;
  };
  // Another block, shorter and of other greys, before other clutter.
  const Eigen::Vector3f grey(0.5F, 0.5F, 0.5F);
  const Eigen::Vector3f white(0.9F, 0.9F, 0.9F);
  const Mesh cousin = testing::Box({-1.5, -1, -0.8F}, {1.5, 1, 0.8F}, {white, white, white, white, grey, grey});
  Random random(9);
  std::vector<cv::Mat> backgrounds;
  for (int i = 0; i < 10; ++i) {
    cv::Mat& background = backgrounds.emplace_back();
    cv::cvtColor(Clutter(random), background, cv::COLOR_BGR2GRAY);
  }
  int right = 0;
  const std::vector<LabelledImage> images = RenderCadExamples(cousin, "", backgrounds, {.views = 10}, 5).value();
  for (const LabelledImage& image : images) right += label(image.grey) == "block" ? 1 : 0;
  for (const cv::Mat& background : backgrounds) right += label(background) == "nothing" ? 1 : 0;
  EXPECT_GE(right, 15);  // 10 by chance
}

TEST_F(CadExampleTest, RequiresBackgroundImages) {
  for (CategoryListRow& row : rows_) row.box = Box{0, 0, 50, 50};
  AddCad();
  const Expected<CategoryModel> model = Train();
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().message, HasSubstr("row 17: a CAD file requires background images"));
}

TEST_F(CadExampleTest, RefusesBoxesAndDamagedFiles) {
  AddCad();
  rows_.back().box = Box{0, 0, 5, 5};
  EXPECT_THAT(Train().error().message, HasSubstr("row 17: a box"));
  rows_.back().box.reset();
  std::ofstream(folder_ / "block.glb", std::ios::binary) << "glTF";
  const Expected<CategoryModel> model = Train();
  ASSERT_FALSE(model);
  EXPECT_THAT(model.error().message, HasSubstr("block.glb"));
}

}  // namespace
}  // namespace victorious
