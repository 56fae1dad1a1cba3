// A recorder beside a source on the loopback interface: what it writes is what was sent.
#include "victorious/input/video/stream_recorder.h"

#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/loopback_server.h"
#include "testing/video_tools.h"
#include "victorious/base/file_lock.h"
#include "victorious/base/utc.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::LoopbackServer;

constexpr int kFrames = 120;  // 25 a second, a key frame each 12

std::string NumberedStream() {
  const testing::ScratchFolder folder;
  std::vector<testing::TestPacket> klv;
  for (int second = 0; second < kFrames / 25; ++second) {
    klv.push_back({.pts = second * 25, .bytes = "klv of second " + std::to_string(second)});
  }
  testing::WriteTestVideo(
      folder / "live.ts",
      {.muxer = "mpegts", .time_base_hz = 25, .pts = testing::SteadyTimes(kFrames, 1), .max_b_frames = 0, .klv = klv});
  return testing::ReadBytes(folder / "live.ts");
}

class StreamRecorderTest : public ::testing::Test {
 protected:
  // Records what the server sends, until it has sent it all.
  Status Record(RecordOptions options) {
    LoopbackServer server;
    server.Serve(NumberedStream(), 0);
    CancelToken cancel;
    const auto warn = [&](const std::string&) { cancel.Cancel(); };  // the server serves once
    options.folder = folder_ / "recordings";
    options.timeout_s = 2;
    const auto enter = [&](const RecordedFile& file) { files_.push_back(file); };
    return RecordStream(server.Url("tcp"), options, cancel, enter, warn);
  }

  static std::vector<int> FramesOf(const fs::path& file) {
    std::vector<int> numbers;
    const auto reader = VideoReader::Open(file, {}).value();
    while (const auto frame = reader->NextFrame().value()) numbers.push_back(testing::DecodeImageNumber(frame->image));
    EXPECT_TRUE(reader->warnings().empty()) << reader->warnings().front();
    return numbers;
  }

  testing::ScratchFolder folder_;
  std::vector<RecordedFile> files_;
};

TEST_F(StreamRecorderTest, FilesBeginAtKeyFramesAndHoldEveryFrame) {
  const std::int64_t before_us = NowUtcMicroseconds();
  const Status recorded = Record({.segment_s = 1, .max_bytes = 1'000'000'000});
  ASSERT_TRUE(recorded) << recorded.error().message;
  ASSERT_EQ(files_.size(), 4U);
  int next = 0;
  for (const RecordedFile& file : files_) {
    EXPECT_EQ(RecordingStart(file.path), file.start_utc_us);
    EXPECT_EQ(next % 12, 0) << "a key frame";
    for (const int number : FramesOf(file.path)) EXPECT_EQ(number, next++);
  }
  EXPECT_EQ(next, kFrames);
  const auto listed = ListRecordings(folder_ / "recordings").value();
  ASSERT_EQ(listed.size(), files_.size());
  for (std::size_t i = 0; i < listed.size(); ++i) EXPECT_EQ(listed[i].path, files_[i].path) << "by time";
  EXPECT_GT(listed.front().start_utc_us, before_us - 5'000'000);
  EXPECT_LT(listed.back().start_utc_us, NowUtcMicroseconds());
}

TEST_F(StreamRecorderTest, TelemetryIsKeptFromTheFirstFrameOn) {
  ASSERT_TRUE(Record({.segment_s = 1, .max_bytes = 1'000'000'000}));
  std::set<std::string> found;
  for (const RecordedFile& file : files_) {
    const auto reader = VideoReader::Open(file.path, {.data_packets = true}).value();
    reader->SkipToEnd();
    const std::vector<DataPacket> packets = reader->TakeDataPackets();
    ASSERT_FALSE(packets.empty());
    EXPECT_LE(packets.front().time_s.value_or(1), 0) << "also of a file that begins later than its packet came";
    for (const DataPacket& packet : packets) {
      EXPECT_EQ(packet.kind, DataKind::kKlv);
      found.emplace(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
    }
  }
  EXPECT_THAT(found, ElementsAre("klv of second 0", "klv of second 1", "klv of second 2", "klv of second 3"));
}

TEST_F(StreamRecorderTest, OldestFilesMakeRoom) {
  ASSERT_TRUE(Record({.segment_s = 1, .max_bytes = 1'000'000'000}));
  const std::int64_t bytes = files_[0].bytes + files_[1].bytes;
  fs::remove_all(folder_ / "recordings");
  files_.clear();
  ASSERT_TRUE(Record({.segment_s = 1, .max_bytes = bytes}));
  ASSERT_EQ(files_.size(), 4U);
  const auto listed = ListRecordings(folder_ / "recordings").value();
  ASSERT_FALSE(listed.empty());
  EXPECT_LE(listed.size(), 2U);
  EXPECT_EQ(listed.back().path, files_.back().path);
}

TEST_F(StreamRecorderTest, FileOfAKilledRecorderIsCompleted) {
  fs::create_directories(folder_ / "recordings");
  const std::string name = "2026-05-27T13-14-22.911042Z.ts";
  testing::WriteBytes(folder_ / "recordings" / (name + ".part"), NumberedStream());
  testing::WriteBytes(folder_ / "recordings" / "2026-05-27T13-15-22.000000Z.ts.part", "");
  ASSERT_TRUE(Record({.max_bytes = 1'000'000'000}));
  const auto listed = ListRecordings(folder_ / "recordings").value();
  ASSERT_EQ(listed.size(), 2U);
  EXPECT_EQ(listed.front().path.filename(), name);
  EXPECT_EQ(FormatUtc(listed.front().start_utc_us), "2026-05-27T13:14:22.911042Z");
  for (const auto& entry : fs::directory_iterator(folder_ / "recordings")) EXPECT_NE(entry.path().extension(), ".part");
}

TEST_F(StreamRecorderTest, OneRecorderAFolder) {
  fs::create_directories(folder_ / "recordings");
  const auto lock = FileLock::Try(folder_ / "recordings" / "lock").value();
  const Status refused = Record({});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_THAT(refused.error().message, HasSubstr("another process records into it"));
}

TEST_F(StreamRecorderTest, SourceThatCannotBeRecordedIsRefused) {
  CancelToken cancel;
  const RecordOptions options{.folder = folder_ / "recordings", .timeout_s = 0.5};
  const std::string silent = "udp://127.0.0.1:" + std::to_string(testing::FreeUdpPort());
  for (const auto& [url, code, words] : std::vector<std::tuple<std::string, ErrorCode, std::string>>{
           {folder_ / "video.ts", ErrorCode::kInvalidArgument, "not the address of a live source"},
           {"gopher://h/", ErrorCode::kInvalidArgument, "not a kind of address"},
           {silent, ErrorCode::kNotFound, "no answer within 0.5 s"}}) {
    const Status refused = RecordStream(url, options, cancel, {}, {});
    ASSERT_FALSE(refused) << url;
    EXPECT_EQ(refused.error().code, code) << refused.error().message;
    EXPECT_THAT(refused.error().message, HasSubstr(words));
  }
}

TEST_F(StreamRecorderTest, EndsSoonWhenItIsCancelled) {
  LoopbackServer server;
  server.Serve(NumberedStream(), 60);
  CancelToken cancel;
  std::thread end([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    cancel.Cancel();
  });
  const auto start = std::chrono::steady_clock::now();
  const auto enter = [&](const RecordedFile& file) { files_.push_back(file); };
  EXPECT_TRUE(RecordStream(server.Url("tcp"), {.folder = folder_ / "recordings", .max_bytes = 1'000'000'000}, cancel,
                           enter, {}));
  end.join();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(8));
  ASSERT_EQ(files_.size(), 1U);
  EXPECT_GT(FramesOf(files_.front().path).size(), 100U);
}

TEST(RecordingStartTest, IsThatOfANameOfARecordingOnly) {
  EXPECT_EQ(RecordingStart("/d/1970-01-01T00-00-01.500000Z.ts"), 1'500'000);
  for (const char* name :
       {"1970-01-01T00:00:01.500000Z.ts", "1970-01-01T00-00-01.5Z.ts", "1970-01-01T00-00-01.500000Z",
        "1970-01-01T00-00-01.500000Z.ts.part", "1970-13-01T00-00-01.500000Z.ts", ".ts", "", "flight.ts"}) {
    EXPECT_EQ(RecordingStart(name), std::nullopt) << name;
  }
}

}  // namespace
}  // namespace victorious
