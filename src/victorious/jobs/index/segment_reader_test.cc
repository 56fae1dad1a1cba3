#include "victorious/jobs/index/segment_reader.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "testing/drawn_flight.h"
#include "victorious/input/video/frame_times.h"

namespace victorious {
namespace {

using testing::ScratchFolder;
using testing::ShortFlight;
using testing::SyntheticFlight;

constexpr int kSegmentFrames = 45;

// A key frame every 10 frames, with frames between them that refer to later ones.
std::string WriteSegmentVideo(const std::filesystem::path& path) {
  const SyntheticFlight flight(ShortFlight(kSegmentFrames));
  auto writer = VideoWriter::Create(path, {.width = 256, .height = 192, .fps = 10, .key_frame_interval = 10}).value();
  for (int i = 0; i < kSegmentFrames; ++i) EXPECT_TRUE(writer->Write(flight.Render(i).image));
  EXPECT_TRUE(writer->Finish());
  return path.string();
}

std::vector<Frame> ReadAll(VideoReader& reader) {
  std::vector<Frame> frames;
  while (auto frame = reader.NextFrame().value()) frames.push_back(*std::move(frame));
  return frames;
}

TEST(SegmentReader, ReadsWhatTheWholeVideoHas) {
  const ScratchFolder folder;
  for (const char* name : {"a.mp4", "a.mkv"}) {
    const std::string video = WriteSegmentVideo(folder / name);
    const FrameTable table = ReadFrameTable(video, {}).value().value();
    EXPECT_EQ(table.times_s.size(), std::size_t{kSegmentFrames});
    EXPECT_GE(table.key_times_s.size(), 5U);
    const std::vector<Frame> whole = ReadAll(**VideoReader::Open(video, {}));
    for (const FrameInterval frames :
         {FrameInterval{0, 10}, {5, 20}, {10, 30}, {19, 21}, {23, 31}, {37, kSegmentFrames}, {44, kSegmentFrames}}) {
      const auto reader = SegmentReader::Open(video, {}, table.times_s, frames).value();
      const std::vector<Frame> read = ReadAll(*reader);
      EXPECT_TRUE(reader->IsExact());
      ASSERT_EQ(std::ssize(read), frames.size()) << name << " from " << frames.from;
      for (const Frame& frame : read) {
        const Frame& same = whole[static_cast<std::size_t>(frame.index)];
        EXPECT_EQ(frame.time_s, same.time_s);
        EXPECT_EQ(cv::norm(frame.image, same.image, cv::NORM_INF), 0) << name << " frame " << frame.index;
      }
      EXPECT_EQ(read.front().index, frames.from);
    }
  }
}

// The times of another video: with a frame more, one less, or one at another time.
TEST(SegmentReader, VideoThatIsNotAsListedIsNotExact) {
  const ScratchFolder folder;
  const std::string video = WriteSegmentVideo(folder / "a.mp4");
  const std::vector<double> times_s = ReadFrameTable(video, {}).value().value().times_s;
  const auto is_exact = [&](std::vector<double> listed_s, FrameInterval frames) {
    const auto reader = SegmentReader::Open(video, {}, listed_s, frames).value();
    ReadAll(*reader);
    return reader->IsExact();
  };
  EXPECT_TRUE(is_exact(times_s, {20, 45}));
  std::vector<double> more = times_s;
  more.push_back(4.5);
  EXPECT_FALSE(is_exact(more, {20, 46}));
  EXPECT_FALSE(is_exact({times_s.begin(), times_s.end() - 1}, {20, 44}));
  std::vector<double> other = times_s;
  other[30] += 0.01;
  EXPECT_FALSE(is_exact(other, {20, 45}));
  EXPECT_FALSE(is_exact(other, {30, 45})) << "the first frame";
  EXPECT_TRUE(is_exact(other, {31, 45}));
}

}  // namespace
}  // namespace victorious
