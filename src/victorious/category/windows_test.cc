#include "victorious/category/windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

TEST(Windows, SidesIncreaseToTheShorterImageSide) {
  const WindowOptions options{.min_window_px = 100};
  EXPECT_THAT(WindowSides({640, 200}, options), ElementsAre(100, 130, 169, 200));
  EXPECT_THAT(WindowSides({640, 190}, options), ElementsAre(100, 130, 190));
  EXPECT_THAT(WindowSides({50, 200}, options), ElementsAre(50)) << "an image smaller than any window is one";
}

TEST(Windows, NestedWindowsAreDuplicates) {
  EXPECT_TRUE(IsSameObject({0, 0, 100, 100}, {10, 10, 100, 100}));
  EXPECT_TRUE(IsSameObject({0, 0, 200, 200}, {120, 120, 60, 60}));
  EXPECT_FALSE(IsSameObject({0, 0, 100, 100}, {80, 0, 100, 100}));
}

TEST(Windows, WindowScoreEqualsScoreOfItsCrop) {
  const DenseOptions grid = testing::CoarseGrid();
  CategoryOptions options = testing::SmallOptions();
  options.linear.shapes = {.weight = 2, .dimensions = 8};
  const CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), options).value();
  Random random(5);
  // A single window size, at the image's own scale, aligned with the grid.
  const cv::Mat grey = testing::DrawPair(true, random);
  const WindowOptions windows{.side_px = 120, .min_window_px = 120};
  const std::vector<std::size_t> wanted = {0, 1};
  const std::vector<ScoredWindow> seen = ClassifyWindows(model, grey, grid, windows, wanted);
  ASSERT_EQ(seen.size(), 3U);  // windows of 120 px in 160 px start at 0, 30 and 40: three steps of the grid
  for (const ScoredWindow& window : seen) {
    EXPECT_EQ(window.box.width, 120);
    const cv::Rect part(static_cast<int>(window.box.x), static_cast<int>(window.box.y), 120, 120);
    const CategoryResult alone =
        Classify(model, QuantiseFeatures(model, DenseFeatures(grey(part).clone(), grid)), CategoryMethod::kPhrases);
    // Smoothing uses pixels beyond the border of a window, but not beyond that of a crop.
    for (const std::size_t node : wanted) EXPECT_NEAR(window.result.scores[node].raw, alone.scores[node].raw, 0.02);
  }
}

TEST(Windows, ThresholdGrowsWithNumberOfWindows) {
  CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions()).value();
  Random random(5);
  const cv::Mat grey = testing::DrawPair(true, random);
  const WindowOptions windows{.side_px = 120, .min_window_px = 120};
  ASSERT_EQ(WindowCount(grey.size(), testing::CoarseGrid().step_px, windows), 3U);
  const std::vector<std::size_t> wanted = {0, 1};
  const auto usual = ClassifyWindows(model, grey, testing::CoarseGrid(), windows, wanted);
  model.windows = {.background_category = {}, .windows_per_background = 0.3};  // a tenth of the number of windows
  const auto more = ClassifyWindows(model, grey, testing::CoarseGrid(), windows, wanted);
  ASSERT_EQ(usual.size(), more.size());
  const auto odds = [](const ScoredWindow& window) {
    const double probability = window.result.scores[0].probability;
    return probability / (1 - probability);
  };
  for (std::size_t i = 0; i < usual.size(); ++i) EXPECT_NEAR(odds(more[i]), odds(usual[i]) / 10, 1e-6 * odds(usual[i]));
}

TEST(Windows, AreSortedByScoreAndLimited) {
  const CategoryModel model = TrainCategories(testing::DrawExamples(8, 1), testing::SmallOptions()).value();
  Random random(6);
  cv::Mat grey(160, 240, CV_8UC1);
  for (auto& pixel : cv::Mat_<std::uint8_t>(grey)) pixel = static_cast<std::uint8_t>(random.Below(256));
  const WindowOptions windows{.side_px = 96, .min_window_px = 60};
  const std::vector<std::size_t> wanted = {0};
  ASSERT_GT(WindowCount(grey.size(), testing::CoarseGrid().step_px, windows), kMaxRescoredWindows);
  const auto seen = ClassifyWindows(model, grey, testing::CoarseGrid(), windows, wanted);
  ASSERT_EQ(seen.size(), kMaxRescoredWindows);
  for (std::size_t i = 1; i < seen.size(); ++i)
    EXPECT_GE(seen[i - 1].result.scores[0].probability, seen[i].result.scores[0].probability);
}

TEST(Windows, UniformImageHasNone) {
  const CategoryModel model = TrainCategories(testing::DrawExamples(4, 1), testing::SmallOptions()).value();
  const std::vector<std::size_t> wanted = {0};
  EXPECT_TRUE(ClassifyWindows(model, cv::Mat(100, 140, CV_8UC1, cv::Scalar(90)), {}, {}, wanted).empty());
}

}  // namespace
}  // namespace victorious
