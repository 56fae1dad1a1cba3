#include "victorious/input/video/read_address.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/loopback_server.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using testing::LoopbackServer;

constexpr double kSilence_s = 60;  // the connection stays open longer than the busiest machine needs

struct Received {
  Status status;
  std::string bytes;
};

Received Receive(const std::string& address, const AddressOptions& options = {}) {
  Received received;
  received.status = ReadAddress(address, options, [&](std::span<const std::byte> bytes) -> Status {
    received.bytes.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  });
  return received;
}

std::string Answer(std::size_t announced, const std::string& bytes) {
  return "HTTP/1.0 200 OK\r\nContent-Length: " + std::to_string(announced) + "\r\n\r\n" + bytes;
}

const std::string& SomeBytes() {
  static const std::string bytes = [] {
    std::string some(1'000'003, '\0');
    for (std::size_t i = 0; i < some.size(); ++i) some[i] = static_cast<char>(i * i >> 5);
    return some;
  }();
  return bytes;
}

TEST(ReadAddress, GivesWhatTheServerSends) {
  LoopbackServer server;
  server.Serve(Answer(SomeBytes().size(), SomeBytes()), kSilence_s);
  const Received received = Receive(server.Url("http"));
  EXPECT_TRUE(received.status) << received.status.error().message;
  EXPECT_TRUE(received.bytes == SomeBytes());
}

TEST(ReadAddress, GivesFiles) {
  const testing::ScratchFolder folder;
  const std::string path = folder / "a:b % file";
  std::ofstream(path, std::ios::binary) << SomeBytes();
  EXPECT_TRUE(Receive(path).bytes == SomeBytes());
  EXPECT_EQ(Receive(path + "none").status.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(Receive(path + "none").status.error().message, HasSubstr(path + "none"));
}

TEST(ReadAddress, CutOffIsAnError) {
  for (const std::size_t sent : {0U, 1000U, 900'000U}) {
    LoopbackServer server;
    server.Serve(Answer(SomeBytes().size(), SomeBytes().substr(0, sent)), 0);
    const Received received = Receive(server.Url("http"));
    ASSERT_FALSE(received.status) << sent;
    EXPECT_EQ(received.status.error().code, ErrorCode::kDataLoss);
    EXPECT_THAT(received.status.error().message, HasSubstr("/live.ts: cut off"));
  }
}

TEST(ReadAddress, SaysWhyNothingCame) {
  LoopbackServer server;
  server.Serve("HTTP/1.0 404 Not Found\r\nContent-Length: 0\r\n\r\n", 0);
  const Received missing = Receive(server.Url("http"));
  EXPECT_EQ(missing.status.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.status.error().message, HasSubstr("404"));
  std::string closed;
  {
    const LoopbackServer gone;
    closed = gone.Url("http");
  }
  const Received refused = Receive(closed);
  EXPECT_EQ(refused.status.error().code, ErrorCode::kUnavailable);
  EXPECT_THAT(refused.status.error().message, HasSubstr("refused"));
}

TEST(ReadAddress, GivesUpOnAServerThatSendsNothing) {
  for (const std::string& head : {std::string(), Answer(1000, "some")}) {
    LoopbackServer server;
    server.Serve(head, kSilence_s);
    const Received received = Receive(server.Url("http"), {.timeout_s = 0.3, .is_stopped = {}});
    ASSERT_FALSE(received.status);
    EXPECT_EQ(received.status.error().code, ErrorCode::kUnavailable);
    EXPECT_THAT(received.status.error().message, HasSubstr("nothing came for 0.3 s"));
  }
}

TEST(ReadAddress, Stops) {
  LoopbackServer server;
  server.Serve(Answer(1000, "some"), kSilence_s);
  int asked = 0;
  const Received received = Receive(server.Url("http"), {.is_stopped = [&] { return ++asked > 5; }});
  EXPECT_EQ(received.status.error().code, ErrorCode::kCancelled);
}

TEST(ReadAddress, ErrorOfTheSinkEndsIt) {
  LoopbackServer server;
  server.Serve(Answer(SomeBytes().size(), SomeBytes()), 0);
  const Status status = ReadAddress(
      server.Url("http"), {}, [](std::span<const std::byte>) -> Status { return Fail(ErrorCode::kNoSpace, "full"); });
  EXPECT_EQ(status.error(), (Error{ErrorCode::kNoSpace, "full"}));
}

}  // namespace
}  // namespace victorious
