// Live sources over the loopback: they are read as they come, and none keeps the reader waiting beyond the timeout.
#include <chrono>
#include <future>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "testing/data.h"
#include "victorious/base/check.h"
#include "victorious/video/video_reader.h"
#include "victorious/video/video_test_tools.h"

namespace victorious {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// A TCP server of one connection on a free port of 127.0.0.1.
class Server {
 public:
  Server() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof(address);
    VICTORIOUS_CHECK(::bind(socket_, generic, size) == 0);
    VICTORIOUS_CHECK(::listen(socket_, 1) == 0);
    VICTORIOUS_CHECK(::getsockname(socket_, generic, &size) == 0);
    port_ = ntohs(address.sin_port);
  }
  ~Server() {
    stop_.set_value();
    ::shutdown(socket_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    ::close(socket_);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Accepts in the background, sends `bytes`, then holds the connection open, silent, for `silent_s`.
  void Serve(std::string bytes, double silent_s) {
    thread_ = std::thread([this, bytes = std::move(bytes), silent_s] {
      const int peer = ::accept(socket_, nullptr, nullptr);
      if (peer < 0) return;
      for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t count = ::send(peer, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (count <= 0) break;
        sent += static_cast<std::size_t>(count);
      }
      stop_.get_future().wait_for(std::chrono::duration<double>(silent_s));
      ::close(peer);
    });
  }

  [[nodiscard]] std::string Url(const std::string& scheme) const {
    return scheme + "://127.0.0.1:" + std::to_string(port_) + (scheme == "http" ? "/live.ts" : "");
  }

 private:
  int socket_;
  int port_ = 0;
  std::promise<void> stop_;
  std::thread thread_;
};

std::string TransportStream(int frames) {
  const testing::ScratchFolder folder;
  testing::WriteTestVideo(folder / "live.ts", {.muxer = "mpegts",
                                               .encoder = "mpeg1video",
                                               .time_base_hz = 25,
                                               .pts = testing::SteadyTimes(frames, 1),
                                               .max_b_frames = 0});
  return testing::ReadBytes(folder / "live.ts");
}

int CountFrames(VideoReader& reader) {
  int count = 0;
  while (const auto frame = reader.NextFrame().value()) {
    EXPECT_EQ(testing::PictureNumber(frame->image), count % 256);
    EXPECT_NEAR(frame->time_s, count / 25.0, 1e-4);
    ++count;
  }
  return count;
}

TEST(LiveVideo, ReadOverTcpToItsEnd) {
  Server server;
  server.Serve(TransportStream(60), 0);
  const auto reader = VideoReader::Open(server.Url("tcp"), {.open_timeout_s = 5});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->info().live);
  EXPECT_EQ((*reader)->info().width, 96);
  EXPECT_EQ(CountFrames(**reader), 60);
  EXPECT_TRUE((*reader)->warnings().empty()) << (*reader)->warnings().front();
}

TEST(LiveVideo, ReadOverHttp) {
  Server server;
  server.Serve("HTTP/1.0 200 OK\r\nContent-Type: video/mp2t\r\n\r\n" + TransportStream(60), 0);
  const auto reader = VideoReader::Open(server.Url("http"), {.open_timeout_s = 5});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(CountFrames(**reader), 60);
}

TEST(LiveVideo, ASourceThatFallsSilentEndsWithAWarning) {
  Server server;
  server.Serve(TransportStream(250), 3);
  const auto reader = VideoReader::Open(server.Url("tcp"), {.open_timeout_s = 1});
  ASSERT_TRUE(reader) << reader.error().message;
  const auto start = Clock::now();
  EXPECT_GE(CountFrames(**reader), 240);
  EXPECT_LT(SecondsSince(start), 2.5);
  EXPECT_THAT((*reader)->warnings(), Contains(HasSubstr("the source sent nothing for 1 s")));
  EXPECT_FALSE((*reader)->NextFrame().value()) << "the end stays the end";
}

TEST(LiveVideo, ASourceThatNeverAnswersIsAnErrorInTime) {
  Server silent;
  silent.Serve("", 3);
  for (const std::string& url : {silent.Url("tcp"), std::string("udp://127.0.0.1:18999"), silent.Url("rtsp")}) {
    const auto start = Clock::now();
    const auto reader = VideoReader::Open(url, {.open_timeout_s = 0.5});
    ASSERT_FALSE(reader) << url;
    EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(reader.error().message, HasSubstr("no answer within 0.5 s"));
    EXPECT_THAT(reader.error().message, HasSubstr(url));
    EXPECT_LT(SecondsSince(start), 2.0) << url;
  }
}

TEST(LiveVideo, ARefusedConnectionIsAnErrorAtOnce) {
  std::string url;
  {
    const Server closed;
    url = closed.Url("tcp");
  }
  const auto reader = VideoReader::Open(url, {.open_timeout_s = 5});
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(reader.error().message, HasSubstr("Connection refused"));
}

}  // namespace
}  // namespace victorious
