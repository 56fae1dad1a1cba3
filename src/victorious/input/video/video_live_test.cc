// Live sources over the loopback interface: reading works, and no call blocks beyond the timeout.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/loopback_server.h"
#include "testing/video_tools.h"
#include "victorious/input/video/video_reader.h"

namespace victorious {
namespace {

using ::testing::Contains;
using testing::FreeUdpPort;
using ::testing::HasSubstr;
using testing::Loopback;
using testing::LoopbackServer;
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string TransportStream(int frames, const char* encoder = "mpeg1video") {
  const testing::ScratchFolder folder;
  testing::WriteTestVideo(folder / "live.ts", {.muxer = "mpegts",
                                               .encoder = encoder,
                                               .time_base_hz = 25,
                                               .pts = testing::SteadyTimes(frames, 1),
                                               .max_b_frames = 0});
  return testing::ReadBytes(folder / "live.ts");
}

int CountFrames(VideoReader& reader) {
  int count = 0;
  while (const auto frame = reader.NextFrame().value()) {
    EXPECT_EQ(testing::DecodeImageNumber(frame->image), count % 256);
    EXPECT_NEAR(frame->time_s, count / 25.0, 1e-4);
    ++count;
  }
  return count;
}

TEST(LiveVideo, ReadsTcpToItsEnd) {
  LoopbackServer server;
  server.Serve(TransportStream(60), 0);
  const auto reader = VideoReader::Open(server.Url("tcp"), {.open_timeout_s = 5});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->info().live);
  EXPECT_EQ((*reader)->info().width, 96);
  EXPECT_EQ(CountFrames(**reader), 60);
  EXPECT_TRUE((*reader)->warnings().empty()) << (*reader)->warnings().front();
}

TEST(LiveVideo, ReadsHttp) {
  LoopbackServer server;
  server.Serve("HTTP/1.0 200 OK\r\nContent-Type: video/mp2t\r\n\r\n" + TransportStream(60), 0);
  const auto reader = VideoReader::Open(server.Url("http"), {.open_timeout_s = 5});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(CountFrames(**reader), 60);
}

// Opens a source twice over http, with `head` as response header. Returns whether it is live, and both content ids.
struct Identity {
  bool live = false;
  std::string first, second;
};

Identity IdentityOf(const std::string& head, const std::string& bytes) {
  Identity identity;
  LoopbackServer server;
  for (std::string* id : {&identity.first, &identity.second}) {
    server.Serve("HTTP/1.0 200 OK\r\nContent-Type: video/mp2t\r\n" + head + "\r\n" + bytes, 0);
    const auto reader = VideoReader::Open(server.Url("http"), {.open_timeout_s = 5});
    EXPECT_TRUE(reader) << reader.error().message;
    if (!reader) break;
    identity.live = (*reader)->info().live;
    *id = (*reader)->ContentId(CancelToken(), {}).value();
  }
  return identity;
}

TEST(LiveVideo, HttpSourceOfKnownLengthHasAStableId) {
  const std::string bytes = TransportStream(60);
  const Identity finite = IdentityOf("Content-Length: " + std::to_string(bytes.size()) + "\r\n", bytes);
  EXPECT_FALSE(finite.live);
  EXPECT_EQ(finite.first, finite.second);
  EXPECT_THAT(finite.first, HasSubstr("/live.ts"));
  const Identity live = IdentityOf("", bytes);
  EXPECT_TRUE(live.live);
  EXPECT_NE(live.first, live.second);
}

// Sends datagrams of seven packets each. @param pause  after each: long enough for the receiver
void SendDatagrams(const std::string& bytes, int port, std::chrono::milliseconds pause = std::chrono::milliseconds(1)) {
  constexpr std::size_t kDatagram = std::size_t{7} * 188;
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in address = Loopback(port);
  for (std::size_t at = 0; at < bytes.size(); at += kDatagram) {
    ::sendto(socket, bytes.data() + at, std::min(kDatagram, bytes.size() - at), 0,
             reinterpret_cast<const sockaddr*>(&address), sizeof(address));
    std::this_thread::sleep_for(pause);
  }
  ::close(socket);
}

TEST(LiveVideo, ReadsUdp) {
  const int port = FreeUdpPort();
  std::thread sender([bytes = TransportStream(250), port] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    SendDatagrams(bytes, port);
  });
  const auto reader = VideoReader::Open("udp://127.0.0.1:" + std::to_string(port), {.open_timeout_s = 1.5});
  int count = 0;
  double last_s = -1;
  while (reader) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    EXPECT_GT((*frame)->time_s, last_s);
    last_s = (*frame)->time_s;
    ++count;
  }
  sender.join();
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_GT(count, 100);  // datagrams may be lost, many where the machine is busy
  EXPECT_THAT((*reader)->warnings(), Contains(HasSubstr("the source sent nothing for 1.5 s")));
}

// The analysis of the stream takes longer than the time limit of one read.
TEST(LiveVideo, SourceThatSendsSlowlyIsRead) {
  const int port = FreeUdpPort();
  const std::string bytes = TransportStream(100, "libx264");
  const auto pause = std::chrono::milliseconds(8000 * 7 * 188 / bytes.size());  // 8 s in all
  std::thread sender([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    SendDatagrams(bytes, port, pause);
  });
  const auto reader = VideoReader::Open("udp://127.0.0.1:" + std::to_string(port), {.open_timeout_s = 1});
  double last_s = -1;
  while (reader) {
    const auto frame = (*reader)->NextFrame();
    if (!frame || !*frame) break;
    last_s = (*frame)->time_s;
  }
  sender.join();
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_GT(last_s, 3) << "of the 4 s of the stream";
}

TEST(LiveVideo, SilentSourceEndsWithAWarning) {
  LoopbackServer server;
  constexpr double kSilent_s = 60;  // the connection stays open longer than the busiest machine needs
  server.Serve(TransportStream(250), kSilent_s);
  const auto reader = VideoReader::Open(server.Url("tcp"), {.open_timeout_s = 1});
  ASSERT_TRUE(reader) << reader.error().message;
  const auto start = Clock::now();
  EXPECT_GE(CountFrames(**reader), 240);
  EXPECT_LT(SecondsSince(start), kSilent_s / 2);
  EXPECT_THAT((*reader)->warnings(), Contains(HasSubstr("the source sent nothing for 1 s")));
  EXPECT_FALSE((*reader)->NextFrame().value()) << "the end is reported again";
}

TEST(LiveVideo, UnresponsiveSourceTimesOut) {
  constexpr double kSilent_s = 60;  // the connection stays open longer than the busiest machine needs
  LoopbackServer silent;
  silent.Serve("", kSilent_s);
  for (const std::string& url :
       {silent.Url("tcp"), "udp://127.0.0.1:" + std::to_string(FreeUdpPort()), silent.Url("rtsp")}) {
    const auto start = Clock::now();
    const auto reader = VideoReader::Open(url, {.open_timeout_s = 0.5});
    ASSERT_FALSE(reader) << url;
    EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(reader.error().message, HasSubstr("no answer within 0.5 s"));
    EXPECT_THAT(reader.error().message, HasSubstr(url));
    EXPECT_LT(SecondsSince(start), kSilent_s / 2) << url;
  }
}

TEST(LiveVideo, RefusedConnectionFailsImmediately) {
  std::string url;
  {
    const LoopbackServer closed;
    url = closed.Url("tcp");
  }
  const auto reader = VideoReader::Open(url, {.open_timeout_s = 5});
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(reader.error().message, HasSubstr("Connection refused"));
}

}  // namespace
}  // namespace victorious
