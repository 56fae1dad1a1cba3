#include "victorious/input/video/playable_copy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/video/frame_times.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using testing::DecodeImageNumber;
using testing::NumberedImage;
using testing::ReadBytes;
using testing::ScratchFolder;
using testing::SteadyTimes;
using testing::WriteBytes;
using testing::WriteTestVideo;

struct SeenFrame {
  double time_s = 0;
  int number = 0;
};

std::vector<SeenFrame> ReadAllOfCopy(const std::filesystem::path& path) {
  const auto reader = VideoReader::Open(path.string(), {});
  EXPECT_TRUE(reader) << reader.error().message;
  std::vector<SeenFrame> frames;
  while (reader) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    frames.push_back({(*frame)->time_s, DecodeImageNumber((*frame)->image)});
  }
  if (reader) {
    EXPECT_THAT((*reader)->warnings(), ::testing::IsEmpty());
  }
  return frames;
}

void ExpectSameFrames(const std::filesystem::path& copy, const std::filesystem::path& source) {
  const std::vector<SeenFrame> expected = ReadAllOfCopy(source);
  const std::vector<SeenFrame> frames = ReadAllOfCopy(copy);
  ASSERT_EQ(frames.size(), expected.size()) << source;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].number, expected[i].number) << source << " frame " << i;
    EXPECT_NEAR(frames[i].time_s, expected[i].time_s, 1e-5) << source << " frame " << i;
  }
}

TEST(PlayableCopy, HasTheSameFramesAtTheSameTimes) {
  const std::vector<std::int64_t> varied = {0, 1, 2, 7, 8, 20, 21, 22, 23, 40, 41, 90};
  const struct {
    std::string name, muxer, encoder;
    int b_frames;
    std::vector<std::int64_t> pts;
    bool is_remuxed;
  } kinds[] = {{"varied.ts", "mpegts", "libx264", 3, varied, true},
               {"late.mkv", "matroska", "libx264", 2, {50, 51, 53, 54, 58, 59, 60, 61}, true},
               {"varied.mp4", "mp4", "libx264", 3, varied, true},
               {"steady.mpg", "mpeg", "mpeg1video", 2, SteadyTimes(30, 1), false},
               {"old.avi", "avi", "mpeg4", 0, SteadyTimes(20, 1), false},
               {"elementary.h264", "h264", "libx264", 0, SteadyTimes(20, 1), false},
               {"varied.mkv", "matroska", "libx265", 3, varied, false}};
  const ScratchFolder folder;
  for (const auto& kind : kinds) {
    const auto source = folder / kind.name;
    WriteTestVideo(source, {.muxer = kind.muxer,
                            .encoder = kind.encoder,
                            .time_base_hz = 25,
                            .pts = kind.pts,
                            .max_b_frames = kind.b_frames,
                            .audio = kind.encoder == "libx264" && kind.muxer == "mpegts"});
    const auto path = folder / (kind.name + ".copy.mp4");
    const auto copy = WritePlayableCopy(source.string(), path, {});
    ASSERT_TRUE(copy) << kind.name << copy.error().message;
    EXPECT_EQ(copy->is_remuxed, kind.is_remuxed) << kind.name;
    EXPECT_EQ(copy->frames, std::ssize(kind.pts)) << kind.name;
    ExpectSameFrames(path, source);
    const auto reader = VideoReader::Open(path.string(), {});
    EXPECT_EQ((*reader)->info().codec, "h264");
    EXPECT_GT((*reader)->info().duration_s.value_or(0), ReadAllOfCopy(source).back().time_s)
        << kind.name << ": the last frame is shown for a while";
  }
}

TEST(PlayableCopy, IsUprightWithSquarePixelsAndEvenSides) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "rotated.mp4", {.size = {96, 64}, .pts = SteadyTimes(4, 40), .rotation_deg = 90});
  WriteTestVideo(folder / "wide.mp4", {.size = {96, 64}, .pts = SteadyTimes(4, 40), .pixel_aspect = {4, 3}});
  std::filesystem::create_directory(folder / "odd");
  for (const char* name : {"1.png", "2.png"}) {
    ASSERT_TRUE(WriteImage((folder / "odd" / name).string(), NumberedImage(5, {95, 63})));
  }
  const struct {
    std::string name;
    int width, height;
  } kinds[] = {{"rotated.mp4", 64, 96}, {"wide.mp4", 128, 64}, {"odd", 96, 64}};
  for (const auto& kind : kinds) {
    const auto path = folder / (kind.name + ".copy.mp4");
    const auto copy = WritePlayableCopy((folder / kind.name).string(), path, {});
    ASSERT_TRUE(copy) << kind.name << copy.error().message;
    EXPECT_FALSE(copy->is_remuxed);
    const auto reader = VideoReader::Open(path.string(), {});
    ASSERT_TRUE(reader);
    EXPECT_EQ((*reader)->info().width, kind.width) << kind.name;
    EXPECT_EQ((*reader)->info().height, kind.height) << kind.name;
    EXPECT_EQ((*reader)->info().rotation_deg, 0);
  }
}

TEST(PlayableCopy, DamagedFilesAreDecoded) {
  const ScratchFolder folder;
  WriteTestVideo(folder / "whole.ts",
                 {.muxer = "mpegts", .time_base_hz = 25, .pts = SteadyTimes(60, 1), .max_b_frames = 2});
  // From the middle of a group of pictures on.
  const std::string bytes = ReadBytes(folder / "whole.ts");
  WriteBytes(folder / "cut.ts", bytes.substr(bytes.size() / 188 / 3 * 188));
  const auto copy = WritePlayableCopy((folder / "cut.ts").string(), folder / "copy.mp4", {});
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_FALSE(copy->is_remuxed);
  EXPECT_GT(copy->frames, 0);
  const auto table = ReadFrameTimes((folder / "cut.ts").string(), copy->frames, {});
  const std::vector<SeenFrame> frames = ReadAllOfCopy(folder / "copy.mp4");
  ASSERT_EQ(frames.size(), table->size());
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_NEAR(frames[i].time_s, (*table)[i], 1e-5);
}

// MP4 has 32 bits for the duration of a frame.
TEST(PlayableCopy, LongGapsAreNotRemuxed) {
  const ScratchFolder folder;
  constexpr std::int64_t kMost = INT32_MAX / 4;
  for (const std::int64_t gap : {kMost, kMost + 1}) {
    WriteTestVideo(folder / "gap.mp4", {.muxer = "mp4", .time_base_hz = 90'000, .pts = {0, 3600, 7200, 7200 + gap}});
    const auto copy = WritePlayableCopy((folder / "gap.mp4").string(), folder / "copy.mp4", {});
    ASSERT_TRUE(copy) << copy.error().message;
    EXPECT_EQ(copy->is_remuxed, gap == kMost) << gap;
    ExpectSameFrames(folder / "copy.mp4", folder / "gap.mp4");
  }
}

TEST(PlayableCopy, FailsWithoutAFile) {
  const ScratchFolder folder;
  const auto out = folder / "copy.mp4";
  EXPECT_EQ(WritePlayableCopy((folder / "none.ts").string(), out, {}).error().code, ErrorCode::kNotFound);
  WriteBytes(folder / "text.mp4", "no video");
  EXPECT_FALSE(WritePlayableCopy((folder / "text.mp4").string(), out, {}));
  for (const char* muxer : {"mpegts", "matroska"}) {
    WriteTestVideo(folder / "video", {.muxer = muxer, .pts = SteadyTimes(20, 40)});
    CancelToken cancel;
    cancel.Cancel();
    EXPECT_EQ(WritePlayableCopy((folder / "video").string(), out, cancel).error().code, ErrorCode::kCancelled);
  }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    files += entry.path().filename().string().find("copy") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(files, 0) << "no file, and no part of one";
}

}  // namespace
}  // namespace victorious
