#include "testing/synthetic_flight.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "victorious/geometry/homography.h"

namespace victorious::testing {
namespace {

FlightOptions SmallFlight(std::uint64_t seed) {
  FlightOptions options;
  options.seed = seed;
  options.width = 320;
  options.height = 240;
  options.object_scale = 0.5;
  return options;
}

double LargestDifference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

/// Mean absolute difference of the green channel between an object's opaque pixels and the frame at their true
/// positions, shifted by `aside_px`.
double MeanDifference(const cv::Mat& image, const cv::Mat& photo, const Eigen::Matrix3d& frame_from_object,
                      const Eigen::Vector2d& aside_px) {
  double sum = 0;
  int count = 0;
  const cv::Rect whole({0, 0}, image.size());
  for (int y = 0; y < photo.rows; ++y) {
    for (int x = 0; x < photo.cols; ++x) {
      const auto& pixel = photo.at<cv::Vec4b>(y, x);
      const Eigen::Vector2d at = ApplyHomography(frame_from_object, {x + 0.5, y + 0.5}) + aside_px;
      const cv::Point nearest(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())));
      if (pixel[3] < 255 || !whole.contains(nearest)) continue;
      sum += std::abs(image.at<cv::Vec3b>(nearest)[1] - pixel[1]);
      ++count;
    }
  }
  return sum / count;
}

std::optional<TruthRow> TruthOf(const SyntheticFlight& flight, int object, int index) {
  for (const TruthRow& row : flight.Truth(index)) {
    if (row.object_index == object) return row;
  }
  return std::nullopt;
}

TEST(SyntheticFlightTest, IsDeterministicBySeedForAnyNumberOfThreads) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const cv::Mat alone = SyntheticFlight(SmallFlight(5)).Render(31).image;
  cv::setNumThreads(4);
  const SyntheticFlight flight(SmallFlight(5));
  const cv::Mat shared = flight.Render(31).image;
  const cv::Mat again = flight.Render(31).image;
  cv::setNumThreads(threads);
  EXPECT_EQ(LargestDifference(alone, shared), 0);
  EXPECT_EQ(LargestDifference(alone, again), 0);
  EXPECT_GT(LargestDifference(alone, SyntheticFlight(SmallFlight(6)).Render(31).image), 60);
}

TEST(SyntheticFlightTest, FramesHaveIndexAndTime) {
  FlightOptions options = SmallFlight(1);
  options.fps = 4;
  const Frame frame = SyntheticFlight(options).Render(10);
  EXPECT_EQ(frame.index, 10);
  EXPECT_DOUBLE_EQ(frame.time_s, 2.5);
  EXPECT_EQ(frame.image.type(), CV_8UC3);
  EXPECT_EQ(frame.image.size(), cv::Size(320, 240));
}

TEST(SyntheticFlightTest, ObjectsAreRenderedAtTheirTruth) {
  FlightOptions options = SmallFlight(2);
  options.objects = 4;
  options.object_scale = 0.9;
  const SyntheticFlight flight(options);
  int compared = 0;
  for (int index = 0; index < options.frames; index += 6) {
    const cv::Mat image = flight.Render(index).image;
    for (const TruthRow& row : flight.Truth(index)) {
      if (row.visible < 1) continue;
      const cv::Mat photo = flight.ObjectPhoto(row.object_index);
      const Eigen::Matrix3d frame_from_object = flight.FrameFromObject(row.object_index, index);
      const double here = MeanDifference(image, photo, frame_from_object, {0, 0});
      EXPECT_LT(here, 24) << row.object << " in frame " << index;
      for (const Eigen::Vector2d& aside : {Eigen::Vector2d(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        EXPECT_LT(here, 0.97 * MeanDifference(image, photo, frame_from_object, aside))
            << row.object << " in frame " << index << ", " << aside.transpose() << " px aside";
      }
      ++compared;
    }
  }
  EXPECT_GE(compared, 10);
}

TEST(SyntheticFlightTest, TruthOfAVisibleObjectIsItsOutline) {
  FlightOptions options = SmallFlight(3);
  options.objects = 4;
  const SyntheticFlight flight(options);
  int whole = 0;
  for (int index = 0; index < options.frames; index += 5) {
    for (const TruthRow& row : flight.Truth(index)) {
      EXPECT_GT(row.pixels, 0);
      EXPECT_LE(row.visible, 1.0);
      EXPECT_GE(row.box.x, 0);
      EXPECT_LE(row.box.x + row.box.width, options.width);
      EXPECT_LE(row.box.y + row.box.height, options.height);
      if (row.visible < 1) continue;
      const Box around = BoundingBox(row.outline);
      EXPECT_NEAR(row.box.x, around.x, 1.6) << row.object << " in frame " << index;
      EXPECT_NEAR(row.box.y, around.y, 1.6);
      EXPECT_NEAR(row.box.width, around.width, 2.6);
      EXPECT_NEAR(row.box.height, around.height, 2.6);
      const double area = std::abs(SignedArea(row.outline));
      EXPECT_NEAR(row.pixels, area, 0.06 * area);
      ++whole;
    }
  }
  EXPECT_GE(whole, 20);
}

TEST(SyntheticFlightTest, ObjectsLeaveTheViewAndReturn) {
  FlightOptions options = SmallFlight(4);
  options.objects = 3;
  const SyntheticFlight flight(options);
  EXPECT_TRUE(TruthOf(flight, 0, 0));
  EXPECT_FALSE(TruthOf(flight, 0, 60));
  EXPECT_TRUE(TruthOf(flight, 0, 119));
  EXPECT_TRUE(TruthOf(flight, 2, 60));
  int together = 0;
  for (int index = 0; index < options.frames; ++index) {
    const auto first = TruthOf(flight, 0, index);
    const auto second = TruthOf(flight, 1, index);
    together += first && second && first->visible >= 0.5 && second->visible >= 0.5;
  }
  EXPECT_GE(together, 10);
}

TEST(SyntheticFlightTest, NamesAreUnique) {
  FlightOptions options = SmallFlight(4);
  options.objects = 6;
  const SyntheticFlight flight(options);
  EXPECT_EQ(flight.ObjectName(0), "crate");
  EXPECT_EQ(flight.ObjectName(1), "truck");
  EXPECT_EQ(flight.ObjectName(4), "crate2");
  const auto row = TruthOf(flight, 0, 0);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->model, "crate");
  EXPECT_EQ(row->object, "crate-1");
}

TEST(DrawObject, OutlinesEncloseOpaquePixels) {
  for (int kind = 0; kind < kNumObjectKinds; ++kind) {
    const SyntheticObject object = DrawObject(static_cast<ObjectKind>(kind), 1);
    ASSERT_EQ(object.image.type(), CV_8UC4);
    cv::Mat alpha;
    cv::extractChannel(object.image, alpha, 3);
    EXPECT_NEAR(cv::sum(alpha)[0] / 255, std::abs(SignedArea(object.outline)), 0.03 * cv::sum(alpha)[0] / 255)
        << Name(static_cast<ObjectKind>(kind));
  }
}

TEST(DrawObject, SeedsGiveDistinguishableObjects) {
  for (int kind = 0; kind < kNumObjectKinds; ++kind) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      cv::Mat a = DrawObject(static_cast<ObjectKind>(kind), seed).image;
      cv::Mat b = DrawObject(static_cast<ObjectKind>(kind), seed + 1).image;
      cv::cvtColor(a, a, cv::COLOR_BGRA2GRAY);
      cv::cvtColor(b, b, cv::COLOR_BGRA2GRAY);
      const cv::Rect middle(a.cols / 4, a.rows / 4, a.cols / 2, a.rows / 2);
      EXPECT_GT(cv::norm(a(middle), b(middle), cv::NORM_L1) / middle.area(), 12)
          << Name(static_cast<ObjectKind>(kind)) << " " << seed;
    }
  }
}

}  // namespace
}  // namespace victorious::testing
