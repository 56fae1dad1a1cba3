// Synthetic images of two categories with the same parts: a cross beside a disc, in this order or in the other one.
#pragma once

#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/category/category_model.h"
#include "victorious/category/common/dense_features.h"

namespace victorious::testing {

/// Draws a cross to the left (cross_first) or to the right of a disc, at a random position, on weak noise.
/// Returns CV_8UC1, 160 x 120 px.
inline cv::Mat DrawPair(bool cross_first, Random& random) {
  cv::Mat image(120, 160, CV_8UC1);
  for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(100 + random.Below(8));
  const int x = 30 + static_cast<int>(random.Below(50));
  const int y = 30 + static_cast<int>(random.Below(60));
  constexpr int kApart = 40;
  const cv::Point cross(cross_first ? x : x + kApart, y);
  const cv::Point disc(cross_first ? x + kApart : x, y);
  cv::line(image, cross - cv::Point(14, 0), cross + cv::Point(14, 0), 230, 6);
  cv::line(image, cross - cv::Point(0, 14), cross + cv::Point(0, 14), 230, 6);
  cv::circle(image, disc, 14, 20, cv::FILLED);
  return image;
}

/// A coarse grid, for fast tests.
inline DenseOptions CoarseGrid() { return {.step_px = 10, .sizes = 3}; }

/// Draws `images_each` images of each category, with dense features.
inline std::vector<CategoryExample> DrawExamples(int images_each, std::uint64_t seed) {
  Random random(seed);
  std::vector<CategoryExample> examples;
  for (int i = 0; i < 2 * images_each; ++i) {
    const bool cross_first = i % 2 == 0;
    examples.push_back({.category = cross_first ? "cross-disc" : "disc-cross",
                        .features = DenseFeatures(DrawPair(cross_first, random), CoarseGrid()),
                        .image = i});
  }
  return examples;
}

/// Options for small, fast models.
inline CategoryOptions SmallOptions(CategoryScoring scoring = CategoryScoring::kLinear) {
  CategoryOptions options;
  options.scoring = scoring;
  options.vocabulary = {.words = 60, .root = true, .iterations = 6, .samples = 4000};
  options.linear.phrases.word_clusters = 24;
  options.linear.fisher = {.components = 8, .dimensions = 12, .samples = 1000, .iterations = 5};
  options.thesis.plsa.iterations = 15;
  options.thesis.plsa.restarts = 1;
  options.thesis.grammar.word_fraction = 0.5;
  return options;
}

}  // namespace victorious::testing
