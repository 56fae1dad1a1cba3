#include "victorious/apps/decoder/frame_request.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::ElementsAre;

TEST(FrameRequest, KeepsAllFields) {
  const FrameRequest crop{
      .task = FrameTask::kJpeg, .video = "a b/ü.mp4", .time_s = 1.0 / 3, .box = Box{1.5, -2, 30, 40}, .width_px = 240};
  const FrameRequest same = UnpackFrameRequest(PackFrameRequest(crop));
  EXPECT_EQ(same.video, crop.video);
  EXPECT_EQ(same.time_s, crop.time_s);
  EXPECT_EQ(same.box, crop.box);
  EXPECT_EQ(same.width_px, crop.width_px);
  EXPECT_FALSE(same.frames);
  EXPECT_EQ(UnpackFrameRequest(PackFrameRequest({.task = FrameTask::kTimes, .frames = 7})).frames, 7);
}

// The process that writes them may be taken over.
TEST(FrameRequest, TimesMustIncrease) {
  const std::vector<double> times_s = {0, 0.04, 0.08};
  EXPECT_EQ(UnpackTimes(PackTimes(times_s)), times_s);
  for (const std::vector<double>& wrong :
       {std::vector{0.0, 0.0}, {1.0, 0.5}, {-1.0}, {std::nan("")}, {0.0, std::numeric_limits<double>::infinity()}}) {
    EXPECT_FALSE(UnpackTimes(PackTimes(wrong)));
  }
  std::string bytes = PackTimes(times_s);
  bytes.pop_back();
  EXPECT_FALSE(UnpackTimes(bytes));
  EXPECT_FALSE(UnpackTimes(std::string(8, '\xff')));
}

TEST(FrameRequest, GreyImageMustHaveItsPixels) {
  const cv::Mat whole = (cv::Mat_<std::uint8_t>(2, 3) << 1, 2, 3, 4, 5, 6);
  const cv::Mat part = whole.colRange(1, 3);  // not continuous
  const auto same = UnpackGrey(PackGrey(part));
  ASSERT_TRUE(same);
  EXPECT_THAT((std::vector<std::uint8_t>(same->begin<std::uint8_t>(), same->end<std::uint8_t>())),
              ElementsAre(2, 3, 5, 6));
  std::string bytes = PackGrey(whole);
  bytes.pop_back();
  EXPECT_FALSE(UnpackGrey(bytes));
  EXPECT_FALSE(UnpackGrey("short"));
  EXPECT_FALSE(UnpackGrey(std::string(8, '\xff')));
}

}  // namespace
}  // namespace victorious
