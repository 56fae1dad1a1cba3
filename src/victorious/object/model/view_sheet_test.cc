#include "victorious/object/model/view_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/model/model_builder.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;

// A model of `count` views, 20 degrees apart, all at off-nadir 90 degrees, with thumbnails of this colour.
ObjectModel MakeModelWithViews(int count, const cv::Size& thumbnail, const cv::Scalar& colour) {
  ModelBuilder builder;
  FeatureSet features;
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(builder.Add({.source = "s",
                             .width = 9,
                             .height = 9,
                             .angles = ViewDirection{RadiansFromDegrees(20.0 * i), RadiansFromDegrees(30)}},
                            features, {}, cv::Mat(thumbnail, CV_8UC3, colour)));
  }
  return std::move(builder).Finish({.name = "object", .kind = ModelKind::kCad, .program_version = "0.0.1"});
}

// The number of pixels of the thumbnails' colour.
int CountOf(const cv::Mat& sheet, const cv::Scalar& colour) {
  cv::Mat close;
  cv::inRange(sheet, colour - cv::Scalar::all(6), colour + cv::Scalar::all(6), close);
  return cv::countNonZero(close);
}

TEST(DrawViewSheet, ShowsTheThumbnailOfEveryView) {
  const cv::Scalar blue(220, 60, 30);
  const auto few = DrawViewSheet(MakeModelWithViews(18, {40, 40}, blue));
  ASSERT_TRUE(few) << few.error().message;
  EXPECT_NEAR(CountOf(*few, blue), 18 * 40 * 40, 300);
  const auto many = DrawViewSheet(MakeModelWithViews(100, {40, 40}, blue));  // more than fit in a row
  ASSERT_TRUE(many);
  EXPECT_NEAR(CountOf(*many, blue), 100 * 40 * 40, 2000);
  EXPECT_GT(many->rows, 2 * few->rows);
}

TEST(DrawViewSheet, RefusesMissingOrDamagedThumbnails) {
  ObjectModel old = MakeModelWithViews(2, {8, 8}, {});
  for (ModelView& view : old.views) view.thumbnail = {};
  const auto none = DrawViewSheet(old);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("0.0.1 kept none: remove the model and add it again"));

  ObjectModel damaged = MakeModelWithViews(2, {8, 8}, {});
  damaged.views[1].thumbnail = damaged.views[1].thumbnail.first(20);
  const auto broken = DrawViewSheet(damaged);
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().message, HasSubstr("thumbnail of view 1"));

  EXPECT_FALSE(DrawViewSheet(MakeModelWithViews(1, {300, 20}, {})));
  EXPECT_FALSE(DrawViewSheet(MakeModelWithViews(2001, {2, 2}, {})));
}

TEST(MakeThumbnail, IsCroppedAndReducedToTheGivenSide) {
  cv::Mat image(200, 400, CV_8UC3, cv::Scalar(0, 0, 255));
  image(cv::Rect(100, 50, 160, 80)).setTo(cv::Scalar(0, 255, 0));
  const cv::Mat green = MakeThumbnail(image, {100, 50, 160, 80}, 40);
  EXPECT_EQ(green.size(), cv::Size(40, 20));
  EXPECT_EQ(cv::norm(green, cv::Mat(20, 40, CV_8UC3, cv::Scalar(0, 255, 0)), cv::NORM_INF), 0);
  EXPECT_EQ(MakeThumbnail(image, {390, 190, 100, 100}, 40).size(), cv::Size(10, 10));  // cut, never enlarged
}

}  // namespace
}  // namespace victorious
