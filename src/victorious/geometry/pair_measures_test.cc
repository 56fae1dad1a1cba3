#include "victorious/geometry/pair_measures.h"

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/geometry/similarity.h"

namespace victorious {
namespace {

struct Point {
  double x, y, scale_px, orientation_rad;
};

Point RandomImagePoint(Random& random) {
  return {random.Uniform(-50, 50), random.Uniform(-50, 50), random.Uniform(1, 9), random.Uniform(-kPi, kPi)};
}

Point Moved(const Point& point, const Similarity2& by) {
  const Eigen::Vector2d place = by.Apply({point.x, point.y});
  return {place.x(), place.y(), point.scale_px * by.scale, WrapAngle(point.orientation_rad + by.rotation_rad)};
}

TEST(PairMeasures, MatchTheThesis) {
  const Point i{0, 0, 2, 0.1};
  const Point j{0, 4, 6, 0.5};
  const PairMeasures measures = MeasurePair(i, j);
  EXPECT_DOUBLE_EQ(measures.scale_ratio, 2.0 / 6.0);
  EXPECT_DOUBLE_EQ(measures.mean_scale_to_distance, 1.0);
  EXPECT_NEAR(measures.orientation_difference_rad, 0.4, 1e-12);
  EXPECT_NEAR(measures.mean_orientation_to_line_rad, kPi / 2 - 0.3, 1e-12);
}

TEST(PairMeasures, AreInvariantUnderSimilarities) {
  Random random(1);
  for (int n = 0; n < 1000; ++n) {
    const Point i = RandomImagePoint(random);
    const Point j = RandomImagePoint(random);
    const Similarity2 by{random.Uniform(0.2, 5), random.Uniform(-kPi, kPi), {random.Uniform(-99, 99), 3}};
    const PairMeasures before = MeasurePair(i, j);
    const PairMeasures after = MeasurePair(Moved(i, by), Moved(j, by));
    EXPECT_NEAR(RatioDistortion(before.scale_ratio, after.scale_ratio), 1, 1e-9);
    EXPECT_NEAR(RatioDistortion(before.mean_scale_to_distance, after.mean_scale_to_distance), 1, 1e-9);
    EXPECT_NEAR(OrientationDistortion(before, after), 0, 1e-9);
    EXPECT_NEAR(MeanOrientationDistortion(before, after), 0, 1e-9);
  }
}

TEST(PairMeasures, DistortionsAreSymmetric) {
  Random random(2);
  for (int n = 0; n < 1000; ++n) {
    const Point i = RandomImagePoint(random);
    const Point j = RandomImagePoint(random);
    const Point k = RandomImagePoint(random);
    const Point l = RandomImagePoint(random);
    const auto forth = std::pair(MeasurePair(i, j), MeasurePair(k, l));
    const auto back = std::pair(MeasurePair(j, i), MeasurePair(l, k));
    EXPECT_NEAR(RatioDistortion(forth.first.scale_ratio, forth.second.scale_ratio),
                RatioDistortion(back.first.scale_ratio, back.second.scale_ratio), 1e-9);
    EXPECT_NEAR(OrientationDistortion(forth.first, forth.second), OrientationDistortion(back.first, back.second), 1e-9);
    EXPECT_NEAR(MeanOrientationDistortion(forth.first, forth.second),
                MeanOrientationDistortion(back.first, back.second), 1e-9);
  }
}

TEST(PairMeasures, OppositeOrientationsHaveAStableMean) {
  const Point i{0, 0, 2, 0.0};
  const PairMeasures just_below = MeasurePair(i, Point{9, 0, 2, kPi - 0.01});
  const PairMeasures just_above = MeasurePair(i, Point{9, 0, 2, -kPi + 0.01});
  EXPECT_NEAR(OrientationDistortion(just_below, just_above), 0.02, 1e-9);
  EXPECT_NEAR(MeanOrientationDistortion(just_below, just_above), 0.01, 1e-9);
}

}  // namespace
}  // namespace victorious
