// Fuzzes the video reader: demuxer, decoder, conversion, presentation times and data packets.
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/input/video/video_reader.h"

namespace {

using victorious::FrameColor;
using victorious::VideoReader;
using victorious::testing::SteadyTimes;
using victorious::testing::TestPacket;
using victorious::testing::TestVideo;

// A file in memory with a path that can be opened.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : fd_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    VICTORIOUS_CHECK(fd_ >= 0);
    VICTORIOUS_CHECK(::write(fd_, data, size) == static_cast<ssize_t>(size));
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

void CheckFrame(const victorious::Frame& frame, const victorious::VideoInfo& info, double last_s) {
  VICTORIOUS_CHECK(frame.time_s > last_s);
  VICTORIOUS_CHECK(frame.image.cols == info.width && frame.image.rows == info.height);
  VICTORIOUS_CHECK(!frame.image.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kMaxFrames = 64;
  const MemoryFile file(data, size);
  const FrameColor color = size % 2 == 0 ? FrameColor::kGrey : FrameColor::kBgr;
  const auto reader = VideoReader::Open(file.path(), {.color = color, .data_packets = true, .threads = 1});
  if (!reader) {
    VICTORIOUS_CHECK(reader.error().message.find('\n') == std::string::npos);
    return 0;
  }
  double last_s = -1;
  for (int i = 0; i < kMaxFrames; ++i) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    CheckFrame(**frame, (*reader)->info(), last_s);
    last_s = (*frame)->time_s;
  }
  (*reader)->TakeDataPackets();
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const victorious::testing::ScratchFolder folder;
  std::vector<std::string> seeds;
  const auto add = [&](const TestVideo& video) {
    victorious::testing::WriteTestVideo(folder / "seed", video);
    seeds.push_back(victorious::testing::ReadBytes(folder / "seed"));
  };
  const auto times = SteadyTimes(6, 40);
  const std::vector<TestPacket> klv = {{0, "\x06\x0E\x2B\x34 one"}, {120, "\x06\x0E\x2B\x34 two"}};
  add({.size = {48, 32}, .pts = times, .rotation_deg = 90, .max_b_frames = 2, .audio = true, .cover = true});
  add({.muxer = "mpegts", .size = {48, 32}, .pts = times, .klv = klv});
  add({.muxer = "matroska", .size = {48, 32}, .pts = times, .subtitles = {{0, "one"}, {120, "two"}}});
  add({.muxer = "matroska", .encoder = "ffv1", .pixel_format = "yuv420p10le", .size = {31, 17}, .pts = times});
  add({.muxer = "avi", .encoder = "mpeg4", .size = {48, 32}, .time_base_hz = 25, .pts = SteadyTimes(6, 1)});
  add({.muxer = "mpeg", .encoder = "mpeg1video", .size = {48, 32}, .time_base_hz = 25, .pts = SteadyTimes(6, 1)});
  add({.muxer = "gif", .encoder = "gif", .pixel_format = "rgb8", .size = {48, 32}, .pts = times});
  return seeds;
}
