#include "victorious/jobs/index/shape_background.h"

#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kBackgroundVideoFrames = 200;  // 20 s

std::string WriteVideo(const testing::ScratchFolder& folder, int key_frame_interval) {
  const std::filesystem::path path = folder / "video.mp4";
  testing::WriteTestVideo(
      path, {.pts = testing::SteadyTimes(kBackgroundVideoFrames, 100), .key_frame_interval = key_frame_interval});
  return path.string();
}

// The numbers of the frames that were read.
std::vector<int> FramesRead(int key_frame_interval, double duration_s) {
  const testing::ScratchFolder folder;
  const std::string video = WriteVideo(folder, key_frame_interval);
  const std::vector<cv::Mat> frames = ReadSpreadFrames(video, duration_s, 4, 1, {}).value();
  auto reader = VideoReader::Open(video, {}).value();
  std::vector<int> numbers;
  for (int number = 0; number < kBackgroundVideoFrames; ++number) {
    const cv::Mat image = reader->NextFrame().value()->image;
    for (const cv::Mat& frame : frames) {
      if (cv::norm(frame, image, cv::NORM_INF) == 0) numbers.push_back(number);
    }
  }
  return numbers;
}

TEST(ReadSpreadFrames, IsSpreadOverTheVideo) {
  for (const int key_frame_interval : {12, 1000}) {
    EXPECT_THAT(FramesRead(key_frame_interval, 20), ElementsAre(25, 75, 125, 175)) << key_frame_interval;
  }
}

TEST(ReadSpreadFrames, OfAnUnknownDurationIsOfTheBeginning) { EXPECT_THAT(FramesRead(12, 0), ElementsAre(0, 1, 2, 3)); }

TEST(ReadSpreadFrames, IsEmptyWithoutAVideo) {
  const testing::ScratchFolder folder;
  EXPECT_THAT(ReadSpreadFrames((folder / "none.mp4").string(), 20, 4, 1, {}).value(), IsEmpty());
}

TEST(ReadSpreadFrames, CanBeCancelled) {
  const testing::ScratchFolder folder;
  const std::string video = WriteVideo(folder, 12);
  CancelToken cancel;
  cancel.Cancel();
  const auto frames = ReadSpreadFrames(video, 20, 4, 1, cancel);
  ASSERT_FALSE(frames);
  EXPECT_EQ(frames.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace victorious
