#include "victorious/category/windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

TEST(Windows, SidesRiseToTheShorterSide) {
  const WindowOptions options{.min_window_px = 60, .size_factor = 2};
  EXPECT_THAT(WindowSides({640, 480}, options), ElementsAre(60, 120, 240, 480));
  EXPECT_THAT(WindowSides({640, 470}, options), ElementsAre(60, 120, 240, 470));
  EXPECT_THAT(WindowSides({50, 200}, options), ElementsAre(50)) << "a picture smaller than any window is one";
}

TEST(Windows, ShowTheSameWhereOneLiesInTheOther) {
  EXPECT_TRUE(IsSameObject({0, 0, 100, 100}, {10, 10, 100, 100}, 0.2));
  EXPECT_TRUE(IsSameObject({0, 0, 200, 200}, {120, 120, 60, 60}, 0.2));
  EXPECT_FALSE(IsSameObject({0, 0, 100, 100}, {80, 0, 100, 100}, 0.2));
  EXPECT_TRUE(IsSameObject({0, 0, 100, 100}, {80, 0, 100, 100}, 0.1));
}

TEST(Windows, AWindowIsScoredAsItsCutOut) {
  const DenseOptions grid = testing::CoarseGrid();
  CategoryOptions options = testing::SmallOptions();
  options.shapes = {.weight = 2, .dimensions = 8};
  const CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), options).value();
  Random random(5);
  // A single window size, at the image's own scale, aligned with the grid.
  const cv::Mat grey = testing::DrawPair(true, random);
  const WindowOptions windows{.side_px = 120, .min_window_px = 120, .step_px = 10, .max_rescored = 100};
  const std::vector<std::size_t> wanted = {0, 1};
  const std::vector<ScoredWindow> seen = ClassifyWindows(model, grey, grid, windows, wanted);
  ASSERT_EQ(seen.size(), 5U);  // windows of 120 px in 160 px start at 0, 10, 20, 30 and 40
  for (const ScoredWindow& window : seen) {
    EXPECT_EQ(window.box.width, 120);
    const cv::Rect part(static_cast<int>(window.box.x), static_cast<int>(window.box.y), 120, 120);
    const CategoryResult alone =
        Classify(model, QuantiseFeatures(model, DenseFeatures(grey(part).clone(), grid)), CategoryMethod::kPhrases);
    // Smoothing uses pixels beyond the border of a window, but not beyond that of a crop.
    for (const std::size_t node : wanted) EXPECT_NEAR(window.result.scores[node].raw, alone.scores[node].raw, 0.02);
  }
}

TEST(Windows, WhereThereAreMoreTheBarIsHigher) {
  const CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions()).value();
  Random random(5);
  const cv::Mat grey = testing::DrawPair(true, random);
  WindowOptions windows{.side_px = 120, .min_window_px = 120, .step_px = 10};
  ASSERT_EQ(WindowCount(grey.size(), windows), 5U);
  const std::vector<std::size_t> wanted = {0, 1};
  const auto usual = ClassifyWindows(model, grey, testing::CoarseGrid(), windows, wanted);
  windows.calibration_windows = 0.5;  // a tenth of the number of windows
  const auto more = ClassifyWindows(model, grey, testing::CoarseGrid(), windows, wanted);
  ASSERT_EQ(usual.size(), more.size());
  const auto odds = [](const ScoredWindow& window) {
    const double probability = window.result.scores[0].probability;
    return probability / (1 - probability);
  };
  for (std::size_t i = 0; i < usual.size(); ++i) EXPECT_NEAR(odds(more[i]), odds(usual[i]) / 10, 1e-6 * odds(usual[i]));
}

TEST(Windows, TheLikeliestComeFirstAndNoMoreThanAskedFor) {
  const CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions()).value();
  Random random(6);
  const WindowOptions windows{.side_px = 96, .min_window_px = 60, .max_rescored = 7};
  const std::vector<std::size_t> wanted = {0};
  const auto seen = ClassifyWindows(model, testing::DrawPair(true, random), testing::CoarseGrid(), windows, wanted);
  ASSERT_EQ(seen.size(), 7U);
  for (std::size_t i = 1; i < seen.size(); ++i)
    EXPECT_GE(seen[i - 1].result.scores[0].probability, seen[i].result.scores[0].probability);
}

TEST(Windows, APictureOfNothingHasNone) {
  const CategoryModel model = TrainCategories(testing::DrawExamples(4, 1), testing::SmallOptions()).value();
  const std::vector<std::size_t> wanted = {0};
  EXPECT_TRUE(ClassifyWindows(model, cv::Mat(100, 140, CV_8UC1, cv::Scalar(90)), {}, {}, wanted).empty());
}

}  // namespace
}  // namespace victorious
