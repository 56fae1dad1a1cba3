#include "victorious/pipeline/shape_background.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/recognize/shape_search.h"
#include "victorious/video/video_reader.h"

namespace victorious {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kFrames = 200;  // 20 s

std::string WriteVideo(const testing::ScratchFolder& folder, int key_frame_interval) {
  const std::filesystem::path path = folder / "video.mp4";
  testing::WriteTestVideo(path, {.pts = testing::SteadyTimes(kFrames, 100), .key_frame_interval = key_frame_interval});
  return path.string();
}

// The numbers of the frames that the background is of.
std::vector<int> FramesOf(const std::vector<GradientCells>& background, const std::string& video) {
  auto reader = VideoReader::Open(video, {}).value();
  const std::size_t scales = BackgroundCells(cv::Mat::zeros(64, 96, CV_8U)).size();
  std::vector<int> numbers;
  for (int number = 0; number < kFrames; ++number) {
    const std::vector<GradientCells> cells = BackgroundCells(reader->NextFrame().value()->image);
    for (std::size_t first = 0; first + scales <= background.size(); first += scales) {
      if (background[first + scales - 1].codes == cells.back().codes) numbers.push_back(number);
    }
  }
  return numbers;
}

std::vector<int> FramesOfBackground(int key_frame_interval, double duration_s) {
  const testing::ScratchFolder folder;
  const std::string video = WriteVideo(folder, key_frame_interval);
  return FramesOf(ReadBackground(video, duration_s, 1, {}).value(), video);
}

TEST(ReadBackground, IsSpreadOverTheVideo) {
  for (const int key_frame_interval : {12, 1000}) {
    EXPECT_THAT(FramesOfBackground(key_frame_interval, 20), ElementsAre(25, 75, 125, 175)) << key_frame_interval;
  }
}

TEST(ReadBackground, OfAnUnknownDurationIsOfTheBeginning) {
  EXPECT_THAT(FramesOfBackground(12, 0), ElementsAre(0, 1, 2, 3));
}

TEST(ReadBackground, IsEmptyWithoutAVideo) {
  const testing::ScratchFolder folder;
  EXPECT_THAT(ReadBackground((folder / "none.mp4").string(), 20, 1, {}).value(), IsEmpty());
}

TEST(ReadBackground, CanBeCancelled) {
  const testing::ScratchFolder folder;
  const std::string video = WriteVideo(folder, 12);
  CancelToken cancel;
  cancel.Cancel();
  const auto background = ReadBackground(video, 20, 1, cancel);
  ASSERT_FALSE(background);
  EXPECT_EQ(background.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace victorious
