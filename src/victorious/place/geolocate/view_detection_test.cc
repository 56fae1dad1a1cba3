#include "victorious/place/geolocate/view_detection.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

PlaceView ViewFrom(double off_nadir_deg, float px_per_m) {
  const auto angle = static_cast<float>(RadiansFromDegrees(off_nadir_deg));
  return {.to_camera = {std::sin(angle), 0, std::cos(angle)}, .px_per_m = px_per_m, .border_px = 1000};
}

TEST(ViewDetection, HalfAtItsSizeAndMoreForLargerObjects) {
  const ViewDetectionOptions options{.half_size_px = 40, .slope = 3};
  EXPECT_DOUBLE_EQ(FindProbability(options, ViewFrom(0, 10), 4), 0.5);
  EXPECT_DOUBLE_EQ(FindProbability(options, ViewFrom(0, 10), 8), 8.0 / 9) << "odds grow with the cube of the size";
  EXPECT_DOUBLE_EQ(FindProbability(options, ViewFrom(0, 10), 2), 1.0 / 9);
  EXPECT_EQ(FindProbability(options, ViewFrom(0, 10), 0), 0);
}

TEST(ViewDetection, FramesOfOneViewAreNotIndependent) {
  const ViewDetectionOptions options{.view_angle_deg = 15, .view_size_ratio = 1.5};
  PlaceViews place;
  place.Add(options, ViewFrom(0, 10));
  place.Add(options, ViewFrom(10, 12));
  place.Add(options, ViewFrom(5, 11));
  ASSERT_EQ(place.views().size(), 1);
  EXPECT_EQ(place.looks(), 3);
  EXPECT_FLOAT_EQ(place.Nearest()->px_per_m, 12) << "the largest of them counts";
  place.Add(options, ViewFrom(20, 10));
  place.Add(options, ViewFrom(0, 30));
  EXPECT_EQ(place.views().size(), 3) << "another direction, and another size";
}

TEST(ViewDetection, IndependentViewsMultiplyTheirMisses) {
  const ViewDetectionOptions options{.half_size_px = 40, .slope = 3, .ceiling = 0.8};
  const std::vector<PlaceView> views = {ViewFrom(0, 10), ViewFrom(40, 10)};
  EXPECT_NEAR(FindProbability(options, views, 4), 0.8 * (1 - 0.5 * 0.5), 1e-6);
  EXPECT_NEAR(FindProbability(options, views, 400), 0.8, 1e-4) << "never above the ceiling";
  EXPECT_EQ(FindProbability(options, std::vector<PlaceView>(), 4), 0);
}

TEST(ViewDetection, ObjectsAtTheEdgeAreFoundLess) {
  const ViewDetectionOptions options{.half_size_px = 40, .slope = 3, .border_fraction = 0.25};
  PlaceView view = ViewFrom(0, 10);
  view.border_px = 10;
  EXPECT_DOUBLE_EQ(FindProbability(options, view, 4), 0.5) << "a quarter of 40 px is enough";
  view.border_px = 5;
  EXPECT_DOUBLE_EQ(FindProbability(options, view, 4), 0.25);
  PlaceViews place;
  place.Add(options, view);
  place.Add(options, ViewFrom(0, 9));
  EXPECT_DOUBLE_EQ(FindProbability(options, place.views(), 4) / options.ceiling, 0.5) << "a later frame has it whole";
}

TEST(ViewDetection, KeepsTheLargestOfManyViews) {
  const ViewDetectionOptions options{.view_angle_deg = 1, .view_size_ratio = 1.01};
  PlaceViews place;
  for (int i = 0; i < 60; ++i) place.Add(options, ViewFrom(i, static_cast<float>(1 + i)));
  EXPECT_LE(place.views().size(), 24);
  EXPECT_FLOAT_EQ(place.Nearest()->px_per_m, 60);
}

}  // namespace
}  // namespace victorious
