#include "victorious/category/category_model.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"
#include "victorious/category/category_file.h"
#include "victorious/category/refine.h"

namespace victorious {
namespace {

using testing::DrawExamples;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SmallOptions;

double Accuracy(const CategoryModel& model, std::span<const CategoryExample> examples, CategoryMethod method) {
  double right = 0;
  for (const CategoryExample& example : examples) {
    const CategoryResult result = Classify(model, QuantiseFeatures(model, example.features), method);
    right += model.nodes[result.label].name == example.category ? 1 : 0;
  }
  return right / static_cast<double>(examples.size());
}

TEST(CategoryModel, PhrasesSeparateCategoriesWithEqualWordCounts) {
  const auto model = TrainCategories(DrawExamples(12, 1), SmallOptions());
  ASSERT_TRUE(model.has_value()) << model.error().message;
  EXPECT_GE(Accuracy(*model, DrawExamples(15, 2), CategoryMethod::kPhrases), 0.9);
}

// Examples with a mirrored copy of each image, as recognize/ makes them.
std::vector<CategoryExample> WithMirrorImages(int images_each, bool mirrored_pairs) {
  Random random(11);
  std::vector<CategoryExample> examples;
  for (int i = 0; i < 2 * images_each; ++i) {
    cv::Mat image = testing::DrawPair(mirrored_pairs ? i % 2 == 0 : true, random);
    // If all pairs have the same order, the second category is the image rotated by 90 degrees.
    if (!mirrored_pairs && i % 2 == 1) cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
    const std::string category = i % 2 == 0 ? "cross-disc" : "disc-cross";
    for (const bool mirrored : {false, true}) {
      cv::Mat seen = image;
      if (mirrored) cv::flip(image, seen, 1);
      examples.push_back({.category = category,
                          .features = DenseFeatures(seen, testing::CoarseGrid()),
                          .image = i,
                          .used_for_training = true,
                          .used_for_calibration = !mirrored,
                          .mirrored = mirrored});
    }
  }
  return examples;
}

TEST(CategoryModel, MirroredCategoriesAreNotAugmentedByMirroring) {
  const auto mirrored = TrainCategories(WithMirrorImages(12, true), SmallOptions());
  ASSERT_TRUE(mirrored.has_value()) << mirrored.error().message;
  EXPECT_GE(Accuracy(*mirrored, DrawExamples(15, 2), CategoryMethod::kPhrases), 0.9);

  auto unmarked = WithMirrorImages(12, true);
  for (CategoryExample& example : unmarked) example.mirrored = false;
  const auto confused = TrainCategories(unmarked, SmallOptions());
  EXPECT_LT(Accuracy(*confused, DrawExamples(15, 2), CategoryMethod::kPhrases), 0.8) << "what it mends";
}

TEST(CategoryModel, OtherCategoriesAreAugmentedByMirroring) {
  const auto examples = WithMirrorImages(10, false);
  auto unmarked = examples;
  for (CategoryExample& example : unmarked) example.mirrored = false;
  const auto model = TrainCategories(examples, SmallOptions());
  ASSERT_TRUE(model.has_value()) << model.error().message;
  EXPECT_EQ(EncodeCategoryModel(*model), EncodeCategoryModel(*TrainCategories(unmarked, SmallOptions())));
}

TEST(CategoryModel, StoresMirroredShapesOnlyIfTrainedOnThem) {
  CategoryOptions options = SmallOptions();
  options.linear.shapes = {.weight = 2, .dimensions = 8};
  EXPECT_EQ(TrainCategories(WithMirrorImages(12, true), options).value().linear()->shape_examples.cols(), 24);
  EXPECT_EQ(TrainCategories(WithMirrorImages(12, false), options).value().linear()->shape_examples.cols(), 48);
}

TEST(CategoryModel, ManyImagesAreTrainedWithoutFisherVectors) {
  CategoryOptions options = SmallOptions();
  options.linear.fisher.components = 0;
  const CategoryModel model = TrainCategories(DrawExamples(30, 1), options).value();
  EXPECT_EQ(model.linear()->fisher.size(), 0U);
  EXPECT_GE(Accuracy(model, DrawExamples(15, 2), CategoryMethod::kPhrases), 0.9);
}

TEST(CategoryModel, IsDeterministicBySeed) {
  const auto examples = DrawExamples(4, 1);
  for (const CategoryScoring scoring : {CategoryScoring::kLinear, CategoryScoring::kLikelihood}) {
    const auto bytes = EncodeCategoryModel(*TrainCategories(examples, SmallOptions(scoring)));
    EXPECT_EQ(bytes, EncodeCategoryModel(*TrainCategories(examples, SmallOptions(scoring))))
        << ToText(kCategoryScoringTexts, scoring);
  }
}

TEST(CategoryModel, FileRoundTripKeepsScores) {
  const auto examples = DrawExamples(5, 3);
  for (const CategoryScoring scoring : {CategoryScoring::kLinear, CategoryScoring::kLikelihood}) {
    const auto model = TrainCategories(examples, SmallOptions(scoring));
    ASSERT_TRUE(model.has_value());
    const auto read = ParseCategoryModel(EncodeCategoryModel(*model), "m.vcat");
    ASSERT_TRUE(read.has_value()) << read.error().message;
    for (const CategoryMethod method : {CategoryMethod::kPhrases, CategoryMethod::kWords}) {
      const CategoryResult a = Classify(*model, QuantiseFeatures(*model, examples[0].features), method);
      const CategoryResult b = Classify(*read, QuantiseFeatures(*read, examples[0].features), method);
      for (std::size_t n = 0; n < a.scores.size(); ++n)
        EXPECT_EQ(a.scores[n].probability, b.scores[n].probability) << ToText(kCategoryScoringTexts, scoring);
    }
  }
}

TEST(CategoryModel, FileRoundTripKeepsShapes) {
  const auto examples = DrawExamples(5, 3);
  CategoryOptions options = SmallOptions();
  options.linear.shapes = {.weight = 3, .dimensions = 6};
  const auto model = TrainCategories(examples, options);
  ASSERT_TRUE(model.has_value());
  ASSERT_EQ(model->linear()->shape_examples.cols(), 10);
  const auto read = ParseCategoryModel(EncodeCategoryModel(*model), "m.vcat");
  ASSERT_TRUE(read.has_value()) << read.error().message;
  const CategoryResult a = Classify(*model, QuantiseFeatures(*model, examples[0].features), CategoryMethod::kPhrases);
  const CategoryResult b = Classify(*read, QuantiseFeatures(*read, examples[0].features), CategoryMethod::kPhrases);
  EXPECT_EQ(a.scores[0].raw, b.scores[0].raw);
  EXPECT_FALSE(RefineCategories(*model, {}).has_value());
}

TEST(CategoryModel, FileRoundTripKeepsWindowMeasurements) {
  CategoryModel model = TrainCategories(DrawExamples(4, 3), SmallOptions()).value();
  EXPECT_FALSE(ParseCategoryModel(EncodeCategoryModel(model), "m.vcat")->windows.has_value());
  model.windows = {.background_category = "nothing", .windows_per_background = 71.5};
  const auto read = ParseCategoryModel(EncodeCategoryModel(model), "m.vcat");
  ASSERT_TRUE(read.has_value()) << read.error().message;
  ASSERT_TRUE(read->windows.has_value());
  EXPECT_EQ(read->windows->background_category, "nothing");
  EXPECT_EQ(read->windows->windows_per_background, 71.5);
}

TEST(CategoryModel, OlderFileVersionRequiresRetraining) {
  auto bytes = EncodeCategoryModel(*TrainCategories(DrawExamples(3, 3), SmallOptions()));
  for (const int version : {1, 2, 3}) {
    bytes[8] = static_cast<std::byte>(version);
    const auto read = ParseCategoryModel(bytes, "m.vcat");
    ASSERT_FALSE(read.has_value());
    EXPECT_EQ(read.error().code, ErrorCode::kUnsupported);
    EXPECT_EQ(
        read.error().message,
        fmt::format("m.vcat: written by an older version (format {}; this program reads 4): train again", version));
  }
}

TEST(CategoryModel, DamagedFilesAreRefused) {
  const auto bytes = EncodeCategoryModel(*TrainCategories(DrawExamples(3, 3), SmallOptions()));
  const auto refusal = [](std::vector<std::byte> damaged) {
    const auto read = ParseCategoryModel(damaged, "m.vcat");
    EXPECT_FALSE(read.has_value());
    return read ? std::string() : read.error().message;
  };
  EXPECT_THAT(refusal({}), HasSubstr("not a category model"));
  auto cut = bytes;
  cut.resize(bytes.size() / 2);
  EXPECT_THAT(refusal(cut), HasSubstr("cut off"));
  auto flipped = bytes;
  flipped[bytes.size() / 2] ^= std::byte{1};
  EXPECT_THAT(refusal(flipped), HasSubstr("checksum"));
  auto newer = bytes;
  newer[8] = std::byte{9};
  EXPECT_THAT(refusal(newer), HasSubstr("newer version"));
}

TEST(CategoryModel, HierarchyHasAScorePerLevel) {
  auto examples = DrawExamples(8, 5);
  for (CategoryExample& example : examples) example.category = "pair/" + example.category;
  Random random(3);
  for (int i = 0; i < 8; ++i) {
    cv::Mat noise(120, 160, CV_8UC1);
    for (auto& pixel : cv::Mat_<std::uint8_t>(noise)) pixel = static_cast<std::uint8_t>(random.Below(256));
    examples.push_back(
        {.category = "noise", .features = DenseFeatures(noise, testing::CoarseGrid()), .image = 100 + i});
  }
  for (const CategoryScoring scoring : {CategoryScoring::kLinear, CategoryScoring::kLikelihood}) {
    const auto model = TrainCategories(examples, SmallOptions(scoring));
    ASSERT_TRUE(model.has_value()) << model.error().message;
    std::vector<std::string> names;
    for (const CategoryNode& node : model->nodes) names.push_back(node.name);
    EXPECT_THAT(names, ElementsAre("noise", "pair", "pair/cross-disc", "pair/disc-cross"));
    EXPECT_FALSE(model->nodes[1].can_be_label) << "no image is labelled with it";
    const auto scores =
        Classify(*model, QuantiseFeatures(*model, examples[0].features), CategoryMethod::kPhrases).scores;
    EXPECT_GT(scores[1].probability, 0.5) << ToText(kCategoryScoringTexts, scoring);
    EXPECT_LT(scores[0].probability, 0.5) << ToText(kCategoryScoringTexts, scoring);
  }
}

TEST(CategoryModel, TargetsFollowTheHierarchy) {
  EXPECT_EQ(TrainingTarget("vehicle/car/sedan", "vehicle"), 1);
  EXPECT_EQ(TrainingTarget("vehicle/car", "vehicle/car"), 1);
  EXPECT_EQ(TrainingTarget("vehicle/car", "vehicle/car/sedan"), 0) << "it may be a sedan";
  EXPECT_EQ(TrainingTarget("vehicle/car", "vehicle/truck"), -1);
  EXPECT_EQ(TrainingTarget("vehicles", "vehicle"), -1);
}

TEST(CategoryModel, ErrorsNameWhatIsMissing) {
  const auto refusal = [](std::vector<CategoryExample> examples) {
    const auto model = TrainCategories(examples, SmallOptions());
    return model ? std::string() : model.error().message;
  };
  const auto examples = DrawExamples(3, 1);
  EXPECT_THAT(refusal({}), HasSubstr("no categories"));
  EXPECT_THAT(refusal({examples[0], examples[2]}), HasSubstr("at least two"));
  EXPECT_THAT(refusal({examples[0], examples[2], examples[1]}), HasSubstr("category disc-cross: one image"));
  auto unnamed = examples;
  unnamed[0].category = "a//b";
  EXPECT_THAT(refusal(unnamed), HasSubstr("a//b"));
  auto bare = examples;
  for (CategoryExample& example : bare)
    if (example.category == "disc-cross") example.features = {};
  EXPECT_THAT(refusal(bare), HasSubstr("no features"));
}

}  // namespace
}  // namespace victorious
