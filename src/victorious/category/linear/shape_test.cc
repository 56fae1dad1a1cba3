#include "victorious/category/linear/shape.h"

#include <gtest/gtest.h>

#include "testing/category_tools.h"

namespace victorious {
namespace {

// A bar at an angle across a square image with weak noise.
FeatureSet Bar(double angle_deg, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(96, 96, CV_8UC1);
  for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(100 + random.Below(30));
  cv::ellipse(image, {48, 48}, {40, 8}, angle_deg, 0, 360, 220, cv::FILLED);
  return DenseFeatures(image, {});
}

std::vector<FeatureSet> Bars(std::uint64_t seed) {
  std::vector<FeatureSet> bars;
  for (int i = 0; i < 36; ++i) bars.push_back(Bar(5.0 * i, seed + static_cast<std::uint64_t>(i)));
  return bars;
}

ShapeEncoder LearntShape(const ShapeOptions& options) {
  const std::vector<FeatureSet> bars = Bars(1);
  std::vector<const FeatureSet*> sets;
  for (const FeatureSet& bar : bars) sets.push_back(&bar);
  return ShapeEncoder::Learn(sets, options);
}

TEST(ShapeEncoder, NearestExampleHasSimilarOrientation) {
  const ShapeOptions options{.weight = 1, .dimensions = 16};
  const ShapeEncoder encoder = LearntShape(options);
  ASSERT_EQ(encoder.size(), 16U);
  const std::vector<FeatureSet> bars = Bars(1);
  Eigen::MatrixXf examples(16, 36);
  for (int i = 0; i < 36; ++i) examples.col(i) = encoder.Encode(bars[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 36; ++i) {
    const Eigen::VectorXf shape = encoder.Encode(Bar(5.0 * i, 500 + static_cast<std::uint64_t>(i)));
    EXPECT_NEAR(shape.norm(), 1, 1e-5);
    Eigen::Index nearest = 0;
    CompareShapes(examples, shape).col(0).maxCoeff(&nearest);
    const auto off = static_cast<int>(std::abs(nearest - i));
    EXPECT_LE(std::min(off, 36 - off), 2) << "off by so many times 5 degrees, at " << 5 * i;
  }
}

TEST(ShapeEncoder, EqualShapesCompareAsOne) {
  Eigen::MatrixXf shapes = Eigen::MatrixXf::Identity(3, 3);
  const Eigen::MatrixXf compared = CompareShapes(shapes, shapes);
  EXPECT_FLOAT_EQ(compared(1, 1), 1);
  EXPECT_FLOAT_EQ(compared(0, 1), std::exp(-3.0F));
}

TEST(ShapeEncoder, ZeroWeightGivesEmptyShape) {
  const ShapeEncoder encoder = LearntShape({.weight = 0});
  EXPECT_EQ(encoder.size(), 0U);
  EXPECT_EQ(encoder.Encode(Bar(0, 1)).size(), 0);
}

TEST(ShapeEncoder, NoFeaturesGiveFiniteShape) {
  const ShapeEncoder encoder = LearntShape({.weight = 1, .dimensions = 8});
  EXPECT_TRUE(encoder.Encode({.image_width = 96, .image_height = 96}).allFinite());
}

}  // namespace
}  // namespace victorious
