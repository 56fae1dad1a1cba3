#include "victorious/input/video/frame_times.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using testing::NumberedImage;
using testing::ReadBytes;
using testing::ScratchFolder;
using testing::SteadyTimes;
using testing::WriteBytes;
using testing::WriteTestVideo;

// The times that VideoReader gives the frames.
std::vector<double> DecodedTimes(const std::filesystem::path& path) {
  const auto reader = VideoReader::Open(path.string(), {});
  EXPECT_TRUE(reader) << reader.error().message;
  std::vector<double> times_s;
  while (reader) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    times_s.push_back((*frame)->time_s);
  }
  return times_s;
}

TEST(FrameTimes, EqualThoseOfTheReader) {
  const struct {
    std::string name, muxer, encoder;
    int b_frames;
    std::vector<std::int64_t> pts;
  } kinds[] = {{"steady.mp4", "mp4", "libx264", 3, SteadyTimes(40, 1)},
               {"varied.mp4", "mp4", "libx264", 2, {0, 1, 2, 7, 8, 20, 21, 22, 23, 40, 41, 90}},
               {"late.mkv", "matroska", "libx264", 3, {50, 51, 53, 54, 58, 59, 60, 61}},
               {"steady.ts", "mpegts", "libx264", 3, SteadyTimes(40, 1)},
               {"steady.mpg", "mpeg", "mpeg1video", 2, SteadyTimes(40, 1)},
               {"elementary.h264", "h264", "libx264", 0, SteadyTimes(20, 1)},
               {"old.avi", "avi", "mpeg4", 0, SteadyTimes(20, 1)}};
  const ScratchFolder folder;
  for (const auto& kind : kinds) {
    const auto path = folder / kind.name;
    WriteTestVideo(path, {.muxer = kind.muxer,
                          .encoder = kind.encoder,
                          .time_base_hz = 25,
                          .pts = kind.pts,
                          .max_b_frames = kind.b_frames});
    const std::vector<double> decoded = DecodedTimes(path);
    const auto times = ReadFrameTimes(path.string(), std::ssize(decoded), {});
    ASSERT_TRUE(times) << times.error().message;
    ASSERT_EQ(times->size(), decoded.size()) << kind.name;
    for (std::size_t i = 0; i < decoded.size(); ++i) EXPECT_NEAR((*times)[i], decoded[i], 1e-9) << kind.name << i;
  }
}

// The first frames are decoded, but not shown: times and frames begin behind them.
TEST(FrameTimes, ObeyAnEditList) {
  const ScratchFolder folder;
  const auto path = folder / "edited.mp4";
  WriteTestVideo(path, {.time_base_hz = 10, .pts = SteadyTimes(40, 1), .max_b_frames = 3, .key_frame_interval = 20});
  testing::BeginEditListAt(path, 0.7);
  const std::vector<double> decoded = DecodedTimes(path);
  ASSERT_EQ(decoded.size(), 33U);
  EXPECT_DOUBLE_EQ(decoded.front(), 0);
  const auto times = ReadFrameTimes(path.string(), std::ssize(decoded), {});
  ASSERT_TRUE(times) << times.error().message;
  ASSERT_EQ(times->size(), decoded.size());
  for (std::size_t i = 0; i < decoded.size(); ++i) EXPECT_NEAR((*times)[i], decoded[i], 1e-9) << i;
  const auto reader = VideoReader::Open(path.string(), {});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(testing::DecodeImageNumber((**(*reader)->NextFrame()).image), 7);
  ASSERT_TRUE((*reader)->SeekTo(decoded[20]));
  std::optional<Frame> frame;  // the key frame before it comes first
  do frame = (*reader)->NextFrame().value();
  while (frame && frame->time_s < decoded[20] - 1e-6);
  ASSERT_TRUE(frame);
  EXPECT_EQ(testing::DecodeImageNumber(frame->image), 27);
}

// A file cut off in its middle: the packet that is cut is read, but not decoded.
TEST(FrameTimes, FollowTheNumberOfDecodedFrames) {
  const ScratchFolder folder;
  const auto path = folder / "cut.ts";
  WriteTestVideo(path, {.muxer = "mpegts", .time_base_hz = 25, .pts = SteadyTimes(40, 1)});
  const std::string bytes = ReadBytes(path);
  WriteBytes(path, bytes.substr(0, bytes.size() / 2));
  const std::vector<double> decoded = DecodedTimes(path);
  ASSERT_LT(decoded.size(), 40U);
  EXPECT_EQ(*ReadFrameTimes(path.string(), std::ssize(decoded), {}), decoded);
}

TEST(FrameTimes, OfAFolderOfImagesAreDecoded) {
  const ScratchFolder folder;
  for (const char* name : {"1.png", "2.png", "10.png"}) {
    ASSERT_TRUE(WriteImage(folder / name, cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90))));
  }
  const auto times = ReadFrameTimes(folder.path().string(), std::nullopt, {});
  ASSERT_TRUE(times) << times.error().message;
  EXPECT_EQ(times->size(), 3U);
}

TEST(FrameTimes, ReportUnusableSources) {
  const ScratchFolder folder;
  EXPECT_EQ(ReadFrameTimes((folder / "none.mp4").string(), std::nullopt, {}).error().code, ErrorCode::kNotFound);
  WriteBytes(folder / "text.mp4", "no video");
  EXPECT_EQ(ReadFrameTimes((folder / "text.mp4").string(), std::nullopt, {}).error().code, ErrorCode::kDataLoss);
}

}  // namespace
}  // namespace victorious
