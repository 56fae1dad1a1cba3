#include "experiments/video_frames.h"

#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;

TEST(EvenlySpaced, TakesTheMiddleOfEachEqualPartOnce) {
  EXPECT_THAT(EvenlySpaced(120, 3), ElementsAre(20, 60, 100));
  EXPECT_THAT(EvenlySpaced(2, 5), ElementsAre(0, 1));
  EXPECT_THAT(EvenlySpaced(1, 1), ElementsAre(0));
  EXPECT_TRUE(EvenlySpaced(0, 4).empty());
}

TEST(ReadNumberedFrames, ReadsOnlyTheRequestedFrames) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "video_frames_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(WriteImage(folder / fmt::format("{}.png", i), cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(20 * i))));
  }
  EXPECT_EQ(CountFrames(folder).value(), 7);
  const std::vector<std::int64_t> numbers = {0, 3, 6, 9};
  const Expected<std::vector<Frame>> frames = ReadNumberedFrames(folder, numbers, FrameColor::kBgr);
  ASSERT_TRUE(frames.has_value()) << frames.error().message;
  ASSERT_EQ(frames->size(), 3U) << "there is no frame 9";
  for (std::size_t i = 0; i < frames->size(); ++i) {
    EXPECT_EQ((*frames)[i].index, numbers[i]);
    EXPECT_EQ((*frames)[i].image.at<cv::Vec3b>(8, 8)[0], 20 * numbers[i]);
  }
  EXPECT_EQ(CountFrames(folder / "none.mp4").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace victorious
