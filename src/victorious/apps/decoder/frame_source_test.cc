#include "victorious/apps/decoder/frame_source.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/base/isolated_process.h"
#include "victorious/base/sandbox.h"
#include "victorious/input/image/image_file.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr int kFrameCount = 60;
constexpr std::int64_t kStep_ms = 100;

class FrameSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::WriteTestVideo(video_, {.pts = testing::SteadyTimes(kFrameCount, kStep_ms), .max_b_frames = 2});
  }

  // The number that a frame shows.
  int NumberAt(FrameSource& source, int frame, FrameTask task = FrameTask::kJpeg) {
    const auto answer =
        source.Answer(PackFrameRequest({.task = task, .video = video_.string(), .time_s = frame * kStep_ms / 1000.0}));
    if (!answer) return -1;
    if (task == FrameTask::kGrey) return testing::DecodeImageNumber(*UnpackGrey(*answer));
    return testing::DecodeImageNumber(DecodeImage(std::as_bytes(std::span(*answer)), "frame")->bgr);
  }

  testing::ScratchFolder folder_;
  std::filesystem::path video_ = folder_ / "a.mp4";
};

// The video stays open: each frame is found from wherever the one before left it.
TEST_F(FrameSourceTest, FindsFramesInAnyOrder) {
  FrameSource source;
  for (const int frame : {0, 1, 40, 41, 39, 5, 59, 59, 12, 0, 58}) EXPECT_EQ(NumberAt(source, frame), frame);
  EXPECT_EQ(NumberAt(source, kFrameCount), -1) << "beyond the end";
  EXPECT_EQ(NumberAt(source, 30), 30);
  EXPECT_EQ(NumberAt(source, 31, FrameTask::kGrey), 31);
  EXPECT_EQ(NumberAt(source, 32), 32);
}

TEST_F(FrameSourceTest, GivesTimesAndCrops) {
  FrameSource source;
  const auto times = source.Answer(PackFrameRequest({.task = FrameTask::kTimes, .video = video_.string()}));
  ASSERT_TRUE(times) << times.error().message;
  EXPECT_EQ(UnpackTimes(*times)->size(), kFrameCount);
  const auto crop = source.Answer(
      PackFrameRequest({.video = video_.string(), .time_s = 2, .box = Box{10, 10, 20, 20}, .width_px = 120}));
  ASSERT_TRUE(crop);
  EXPECT_EQ(DecodeImage(std::as_bytes(std::span(*crop)), "crop")->bgr.size(), cv::Size(120, 90));
}

// The program itself, in its sandbox.
class DecoderTest : public FrameSourceTest {
 protected:
  static Expected<std::string> Ask(const FrameRequest& request, std::vector<std::filesystem::path> readable) {
    VICTORIOUS_ASSIGN_OR_RETURN(IsolatedProcess decoder, IsolatedProcess::Start(kPage, {}));
    decoder.Confine({.memory_bytes = std::uint64_t{1} << 30, .readable = std::move(readable)});
    return decoder.Ask(kFrameRequest + PackFrameRequest(request), {});
  }
};

TEST_F(DecoderTest, DecodesInItsSandbox) {
  const auto jpeg = Ask({.video = video_.string(), .time_s = 3}, {video_});
  ASSERT_TRUE(jpeg) << jpeg.error().message;
  EXPECT_THAT(*jpeg, StartsWith("\xFF\xD8\xFF"));
  std::filesystem::create_directory(folder_ / "images");
  ASSERT_TRUE(WriteImage(folder_ / "images/1.png", testing::NumberedImage(1, {96, 64})));
  EXPECT_TRUE(Ask({.video = (folder_ / "images").string()}, {folder_ / "images"}));
}

TEST_F(DecoderTest, ReadsNoOtherVideo) {
  if (FindSandboxSupport().landlock_version == 0) GTEST_SKIP() << "SKIPPED: this kernel has no Landlock";
  const auto other = Ask({.video = video_.string()}, {folder_ / "b.mp4"});
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kPermissionDenied) << other.error().message;
}

// 1 MB in the file, 800 MB in memory.
TEST_F(DecoderTest, LargeImageIsRefusedUndecoded) {
  const std::filesystem::path image = folder_ / "large.png";
  {
    // The header of a PNG of 16384 x 16384 pixels, and its end.
    constexpr unsigned char kBytes[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0,   0, 0,  13,
                                        'I',  'H', 'D', 'R', 0,    0,    64,   0,    0,   0, 64, 0,
                                        8,    2,   0,   0,   0,    0,    0,    0,    0,   0, 0,  0,
                                        0,    'I', 'E', 'N', 'D',  0xAE, 0x42, 0x60, 0x82};
    std::ofstream(image, std::ios::binary).write(reinterpret_cast<const char*>(kBytes), sizeof(kBytes));
  }
  const auto refused = Ask({.video = image.string()}, {image});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("16384 x 16384 pixels, more than the 67108864 that can be read"));
}

}  // namespace
}  // namespace victorious
