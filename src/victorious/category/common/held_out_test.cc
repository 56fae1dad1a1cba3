#include "victorious/category/common/held_out.h"

#include <gtest/gtest.h>

namespace victorious {
namespace {

// Calibration on `images` negative images with `windows_per_image` windows each, of maximum score 0, and on as many
// positive images of score 2.
Calibration CalibrateWithWindows(int images, int windows_per_image) {
  std::vector<CategoryExample> examples;
  std::vector<int> targets;
  std::vector<double> scores;
  for (int image = 0; image < images; ++image) {
    examples.push_back({.category = "object", .image = image});
    targets.push_back(1);
    scores.push_back(2 + 0.1 * (image % 5));
    for (int window = 0; window < windows_per_image; ++window) {
      examples.push_back({.category = "none", .image = images + image});
      targets.push_back(-1);
      scores.push_back(window == 0 ? 0.1 * (image % 5) : -3.0);
    }
  }
  return CalibrateHeldOut(examples, targets, Eigen::Map<const Eigen::VectorXd>(scores.data(), std::ssize(scores)));
}

TEST(HeldOut, NegativeImageCountsItsHighestScore) {
  const Calibration one = CalibrateWithWindows(20, 1);
  const Calibration many = CalibrateWithWindows(20, 30);
  EXPECT_NEAR(one.Probability(1.2), many.Probability(1.2), 1e-9);
  EXPECT_GT(one.Probability(2.2), 0.8);
  EXPECT_LT(many.Probability(0.2), 0.2);
}

}  // namespace
}  // namespace victorious
