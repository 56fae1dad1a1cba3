#include "victorious/category/finder/category_images.h"

#include <algorithm>
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/category_tools.h"
#include "testing/data.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr Box kBox{40, 30, 60, 50};

CategoryFeatureOptions CoarseFeatures(Surroundings surroundings = Surroundings::kLearn, bool mirrored = false) {
  CategoryFeatureOptions options;
  options.surroundings = surroundings;
  options.mirrored = mirrored;
  options.dense = testing::CoarseGrid();
  return options;
}

cv::Mat Pair(bool cross_first, std::uint64_t seed) {
  Random random(seed);
  return testing::DrawPair(cross_first, random);
}

std::vector<CategoryExample> ExamplesWith(const CategoryFeatureOptions& options, const Box& box = kBox,
                                          bool own_surroundings = true) {
  const CategoryFeaturizer featurizer = CategoryFeaturizer::Create(options).value();
  return ExamplesOf(featurizer, Pair(true, 1), box, "cross-disc", 7, own_surroundings).value();
}

TEST(CategoryFeaturizer, RefusesWindowsThatItsFeaturesCannotFill) {
  CategoryFeatureOptions options = CoarseFeatures();
  options.windows.enabled = true;
  options.kind = CategoryFeatureKind::kKeypoints;
  EXPECT_THAT(CategoryFeaturizer::Create(options).error().message, HasSubstr("kind must be dense"));
  options.kind = CategoryFeatureKind::kDense;
  options.windows.side_px = 2 * options.windows.min_window_px + 1;
  EXPECT_THAT(CategoryFeaturizer::Create(options).error().message, HasSubstr("windows.min_window_px"));
  options.windows.side_px = 2 * options.windows.min_window_px;
  EXPECT_TRUE(CategoryFeaturizer::Create(options));
}

TEST(CategoryFeaturizer, OfAModelHasTheOptionsThatItWasTrainedWith) {
  CategoryModel model = TrainCategories(testing::DrawExamples(4, 1), testing::SmallOptions()).value();
  model.features_json = OptionsToJsonText(CoarseFeatures(Surroundings::kNone));
  const auto featurizer = CategoryFeaturizer::Of(model);
  ASSERT_TRUE(featurizer) << featurizer.error().message;
  EXPECT_EQ(featurizer->options().surroundings, Surroundings::kNone);
  EXPECT_EQ(featurizer->options().dense.step_px, testing::CoarseGrid().step_px);
  for (const std::string json : {"", "[", R"({"kind": "wavelets"})"}) {
    model.features_json = json;
    EXPECT_EQ(CategoryFeaturizer::Of(model).error().code, ErrorCode::kDataLoss) << json;
  }
}

TEST(CategoryFeaturizer, OfAModelHasItsEngine) {
  CategoryModel model = TrainCategories(testing::DrawExamples(4, 1), testing::SmallOptions()).value();
  const cv::Mat grey = Pair(true, 1);
  const auto extracted_by = [&](const std::string& engine) {
    FeatureOptions options;
    options.engine = engine;
    return MakeFeatureExtractor(options).value()->Extract(grey).value();
  };
  ASSERT_NE(extracted_by("sift").descriptors, extracted_by("opencv").descriptors);
  CategoryFeatureOptions trained_now;
  trained_now.kind = CategoryFeatureKind::kKeypoints;
  model.features_json = OptionsToJsonText(trained_now);
  EXPECT_EQ(CategoryFeaturizer::Of(model).value().Extract(grey).value().descriptors, extracted_by("sift").descriptors);
  model.features_json = R"({"kind": "keypoints"})";  // from before the engine was stored
  EXPECT_EQ(CategoryFeaturizer::Of(model).value().Extract(grey).value().descriptors,
            extracted_by("opencv").descriptors);
}

TEST(CategoryFeaturizer, KeypointsAndTheGridAreDifferentFeatures) {
  const cv::Mat grey = Pair(true, 1);
  CategoryFeatureOptions options = CoarseFeatures();
  const FeatureSet dense = CategoryFeaturizer::Create(options).value().Extract(grey).value();
  EXPECT_EQ(dense.size(), DenseFeatures(grey, options.dense).size());
  options.kind = CategoryFeatureKind::kKeypoints;
  const FeatureSet keypoints = CategoryFeaturizer::Create(options).value().Extract(grey).value();
  EXPECT_GT(keypoints.size(), 0U);
  EXPECT_NE(keypoints.size(), dense.size());
}

// The roles of the crop and of the whole image, by the option `surroundings`.
TEST(ExamplesOfAnImage, SurroundingsDecideWhatTheWholeImageIsUsedFor) {
  const std::vector<CategoryExample> none = ExamplesWith(CoarseFeatures(Surroundings::kNone));
  ASSERT_THAT(none, SizeIs(1));
  EXPECT_TRUE(none[0].used_for_training && none[0].used_for_calibration);
  EXPECT_EQ(none[0].image, 7);
  EXPECT_EQ(none[0].features.image_width, 60);
  EXPECT_EQ(none[0].features.image_height, 50);

  const std::vector<CategoryExample> calibrate = ExamplesWith(CoarseFeatures(Surroundings::kCalibrate));
  ASSERT_THAT(calibrate, SizeIs(2));
  EXPECT_TRUE(calibrate[0].used_for_training && !calibrate[0].used_for_calibration);
  EXPECT_TRUE(!calibrate[1].used_for_training && calibrate[1].used_for_calibration);
  EXPECT_EQ(calibrate[1].features.image_width, 160) << "the whole image";

  const std::vector<CategoryExample> learn = ExamplesWith(CoarseFeatures(Surroundings::kLearn));
  ASSERT_THAT(learn, SizeIs(2));
  EXPECT_TRUE(learn[1].used_for_training && learn[1].used_for_calibration);
}

TEST(ExamplesOfAnImage, ABoxOfTheWholeImageAndForeignSurroundingsGiveTheCropAlone) {
  EXPECT_THAT(ExamplesWith(CoarseFeatures(), {0, 0, 160, 120}), SizeIs(1));
  EXPECT_THAT(ExamplesWith(CoarseFeatures(), {-20, -20, 500, 500}), SizeIs(1)) << "clipped";
  EXPECT_THAT(ExamplesWith(CoarseFeatures(), kBox, /*own_surroundings=*/false), SizeIs(1));
}

TEST(ExamplesOfAnImage, MirroredCopiesAreOfWhatIsLearnedFromAndCalibrateNothing) {
  const std::vector<CategoryExample> examples = ExamplesWith(CoarseFeatures(Surroundings::kLearn, /*mirrored=*/true));
  ASSERT_THAT(examples, SizeIs(4)) << "the crop, the whole image, and a copy of each";
  EXPECT_EQ(std::ranges::count(examples, true, &CategoryExample::mirrored), 2);
  for (const CategoryExample& example : examples) {
    EXPECT_TRUE(example.used_for_training);
    EXPECT_FALSE(example.mirrored && example.used_for_calibration);
  }
  EXPECT_THAT(ExamplesWith(CoarseFeatures(Surroundings::kCalibrate, /*mirrored=*/true)), SizeIs(3))
      << "the whole image is not learned from";
}

class ImageListTest : public ::testing::Test {
 protected:
  // Writes an image of the list; returns its row.
  CategoryListRow Add(const std::string& name, const std::string& category, std::optional<Box> box = std::nullopt) {
    EXPECT_TRUE(WriteImage(folder_ / name, Pair(category != "disc-cross", next_seed_++)));
    return {.image = name, .category = category, .box = box, .mark = {}, .where = "list.csv line " + name};
  }

  [[nodiscard]] Expected<CategoryModel> Train(const std::vector<CategoryListRow>& rows) const {
    CategoryTrainOptions options;
    options.features = CoarseFeatures();
    options.category = testing::SmallOptions();
    return TrainOnList(folder_.path(), rows, options, [](std::size_t) {});
  }

  testing::ScratchFolder folder_;
  std::uint64_t next_seed_ = 1;
};

TEST_F(ImageListTest, EveryImageIsReadOnceAndCounted) {
  std::vector<CategoryListRow> rows;
  for (int i = 0; i < 9; ++i) rows.push_back(Add(std::to_string(i) + ".png", "cross-disc"));
  std::mutex mutex;
  std::multiset<std::size_t> read;
  std::multiset<std::size_t> counts;
  const Status status = ForEachImage(
      folder_.path(), rows,
      [&](std::size_t row, const cv::Mat& bgr) -> Status {
        EXPECT_EQ(bgr.size(), cv::Size(160, 120));
        const std::scoped_lock lock(mutex);
        read.insert(row);
        return {};
      },
      [&](std::size_t done) { counts.insert(done); });
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(read, (std::multiset<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(counts, (std::multiset<std::size_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(ImageListTest, TheErrorIsTheFirstInTheListsOrder) {
  std::vector<CategoryListRow> rows;
  for (int i = 0; i < 24; ++i) rows.push_back(Add(std::to_string(i) + ".png", "cross-disc"));
  for (const int absent : {5, 6, 13, 23})
    std::filesystem::remove(folder_ / rows[static_cast<std::size_t>(absent)].image);
  for (int repetition = 0; repetition < 10; ++repetition) {
    const Status status = ForEachImage(
        folder_.path(), rows, [](std::size_t, const cv::Mat&) -> Status { return {}; }, [](std::size_t) {});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(status.error().message, AllOf(HasSubstr("list.csv line 5.png"), HasSubstr("5.png")));
  }
}

TEST_F(ImageListTest, TrainingRefusesRowsThatItCannotUseByTheirPlace) {
  const CategoryListRow good = Add("good.png", "cross-disc", kBox);
  const auto refusal = [&](const CategoryListRow& bad) {
    const auto model = Train({good, bad});
    EXPECT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
    return model.error().message;
  };
  EXPECT_THAT(refusal(Add("none.png", "")), AllOf(HasSubstr("list.csv line none.png"), HasSubstr("no category")));
  EXPECT_THAT(refusal(Add("out.png", "disc-cross", Box{500, 0, 10, 10})), HasSubstr("list.csv line out.png"));
  EXPECT_THAT(refusal({.image = "jet.glb", .category = "jet", .box = kBox, .mark = {}, .where = "line 2"}),
              AllOf(HasSubstr("line 2"), HasSubstr("not allowed for a CAD file")));
  EXPECT_THAT(refusal({.image = "jet.glb", .category = "jet", .box = {}, .mark = {}, .where = "line 2"}),
              AllOf(HasSubstr("line 2"), HasSubstr("requires background images")));
}

TEST_F(ImageListTest, ClassifiesNewImagesAsItWasTrained) {
  std::vector<CategoryListRow> rows;
  for (int i = 0; i < 16; ++i) {
    rows.push_back(Add(std::to_string(i) + ".png", i % 2 == 0 ? "cross-disc" : "disc-cross"));
  }
  const auto model = Train(rows);
  ASSERT_TRUE(model) << model.error().message;
  const CategoryFeaturizer featurizer = CategoryFeaturizer::Of(*model).value();
  int right = 0;
  for (std::uint64_t i = 0; i < 16; ++i) {
    const auto seen = ClassifyImage(featurizer, *model, Pair(i % 2 == 0, 100 + i), CategoryMethod::kPhrases);
    ASSERT_TRUE(seen) << seen.error().message;
    EXPECT_EQ(seen->classified_box, (Box{0, 0, 160, 120}));
    right += model->nodes[seen->result.label].name == (i % 2 == 0 ? "cross-disc" : "disc-cross") ? 1 : 0;
  }
  EXPECT_GE(right, 13);
}

}  // namespace
}  // namespace victorious
