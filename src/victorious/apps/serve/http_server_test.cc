// The server over real sockets: limits, time-outs, keep-alive, files in parts, many connections, the end.
#include "victorious/apps/serve/http_server.h"

#include <atomic>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "testing/data.h"
#include "testing/video_tools.h"
#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/byte_range.h"
#include "victorious/apps/serve/event_hub.h"
#include "victorious/base/file.h"

namespace victorious {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Client {
 public:
  /// @param from  its own address, of 127.0.0.0/8
  explicit Client(int port, const char* from = "127.0.0.1") : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    EXPECT_EQ(::inet_pton(AF_INET, from, &own.sin_addr), 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void Send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }

  // Everything until the server closes the connection.
  [[nodiscard]] std::string ReadAll() const {
    std::string text;
    std::array<char, 65536> chunk{};
    ssize_t got = 0;
    while ((got = ::recv(socket_, chunk.data(), chunk.size(), 0)) > 0)
      text.append(chunk.data(), static_cast<std::size_t>(got));
    return text;
  }

  // Until the text ends with `end`.
  [[nodiscard]] std::string ReadUntil(std::string_view end) const {
    std::string text;
    char c = 0;
    while (!text.ends_with(end) && ::recv(socket_, &c, 1, 0) == 1) text += c;
    return text;
  }

 private:
  int socket_;
};

class HttpServerTest : public ::testing::Test {
 protected:
  void Start(HttpServerOptions options = {}) {
    options.port = 0;
    options.threads = 2;
    auto server = HttpServer::Listen(
        options,
        [this](const HttpRequest& request, int port) {
          ++requests_;
          if (request.target == "/file") {
            return FileResponse(request, folder_ / "file.bin", 1'000'000, "application/octet-stream", "\"e\"");
          }
          if (request.target == "/gone") {
            return FileResponse(request, folder_ / "gone.bin", 10, "application/octet-stream", "\"e\"");
          }
          if (request.target == "/events") {
            return HttpResponse{
                .content_type = "text/event-stream", .headers = {}, .body = {}, .file = {}, .events = hub_->Listen()};
          }
          if (request.target == "/slow") return MakeSlow(request);
          if (request.target == "/credentials") {
            return HttpResponse{.content_type = "text/plain",
                                .headers = {},
                                .body = request.client + "|" + request.cookie + "|" + request.authorization,
                                .file = {}};
          }
          if (request.upload && request.target == "/late") return ErrorResponse(401, "no", "logged out meanwhile");
          if (request.upload) {
            return HttpResponse{.content_type = "text/plain",
                                .headers = {},
                                .body = "kept " + std::to_string(std::filesystem::file_size(*request.upload)),
                                .file = {}};
          }
          return HttpResponse{
              .content_type = "text/plain", .headers = {}, .body = request.body + std::to_string(port), .file = {}};
        },
        [this](const HttpRequest& request, int) -> std::expected<UploadPlan, HttpResponse> {
          if (request.target == "/refused") return std::unexpected(ErrorResponse(403, "no", "not here"));
          const auto own = folder_ / ("upload" + std::to_string(++uploads_));
          std::filesystem::create_directory(own);
          return UploadPlan{.file = own / "file", .max_bytes = 1'000'000};
        });
    ASSERT_TRUE(server) << server.error().message;
    server_ = *std::move(server);
    thread_ = std::thread([this] { server_->Run(cancel_); });
  }

  void TearDown() override {
    cancel_.Cancel();
    if (thread_.joinable()) thread_.join();
  }

  // A response that takes until may_end_, or until the client has left.
  HttpResponse MakeSlow(const HttpRequest& request) {
    HttpResponse response;
    response.slow = std::make_shared<SlowResponse>(
        SlowResponse{.client = request.client, .make = [this](const CancelToken& left) {
                       ++begun_;
                       while (!may_end_ && !left.IsCancelled()) std::this_thread::yield();
                       if (left.IsCancelled()) ++left_;
                       return HttpResponse{.content_type = "text/plain", .headers = {}, .body = "slow", .file = {}};
                     }});
    return response;
  }

  std::string Exchange(std::string_view bytes) const {
    const Client client(server_->port());
    client.Send(bytes);
    return client.ReadAll();
  }

  testing::ScratchFolder folder_;
  CancelToken cancel_;
  std::atomic<int> requests_ = 0;
  std::atomic<int> uploads_ = 0;
  std::atomic<bool> may_end_ = false;
  std::atomic<int> begun_ = 0;  // slow responses
  std::atomic<int> left_ = 0;   // those whose client has left
  std::shared_ptr<EventHub> hub_ = std::make_shared<EventHub>();
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

constexpr std::string_view kSlowRequest = "GET /slow HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n";

// More of them than threads answer requests: what is quick does not wait, and what is too much is refused.
TEST_F(HttpServerTest, SlowResponsesHoldUpNoOther) {
  constexpr std::size_t kWaiting = 6;
  Start({.slow = {.threads = 2, .waiting = kWaiting}});
  std::vector<std::unique_ptr<Client>> clients;
  const auto ask = [&] {
    clients.push_back(std::make_unique<Client>(server_->port()));
    clients.back()->Send(kSlowRequest);
  };
  ask();
  while (begun_ == 0) std::this_thread::yield();
  for (std::size_t i = 0; i < kWaiting; ++i) ask();
  while (requests_ < static_cast<int>(clients.size())) std::this_thread::yield();
  EXPECT_THAT(Exchange("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  const std::string refused = Exchange(kSlowRequest);
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(refused, HasSubstr("Retry-After: 3\r\n"));
  EXPECT_THAT(refused, HasSubstr("ask again in some seconds"));
  EXPECT_EQ(begun_, 1) << "the last thread is for other clients";
  may_end_ = true;
  for (const auto& client : clients) EXPECT_THAT(client->ReadAll(), EndsWith("\r\n\r\nslow"));
}

TEST_F(HttpServerTest, SlowResponseEndsWithItsClient) {
  Start({.slow = {.threads = 2}});
  auto made = std::make_unique<Client>(server_->port());
  made->Send(kSlowRequest);
  while (begun_ == 0) std::this_thread::yield();
  auto waits = std::make_unique<Client>(server_->port());
  waits->Send(kSlowRequest);
  auto stays = std::make_unique<Client>(server_->port());
  stays->Send(kSlowRequest);
  while (requests_ < 3) std::this_thread::yield();
  waits.reset();
  Exchange("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n");
  made.reset();
  while (left_ == 0) std::this_thread::yield();
  may_end_ = true;
  EXPECT_THAT(stays->ReadAll(), EndsWith("slow"));
  EXPECT_LE(begun_, 3);
}

TEST_F(HttpServerTest, EndOfTheServerEndsSlowResponses) {
  Start({.slow = {.threads = 2}});
  const Client client(server_->port());
  client.Send(kSlowRequest);
  while (begun_ == 0) std::this_thread::yield();
  TearDown();
  EXPECT_EQ(left_, 1);
}

// The page may fetch from its server, and from the server of map tiles that was named.
TEST_F(HttpServerTest, NamesWhereThePageMayFetchFrom) {
  constexpr std::string_view kRequest = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n";
  Start();
  EXPECT_THAT(Exchange(kRequest), HasSubstr("connect-src 'self'; img-src 'self' data: blob:; "));
  TearDown();
  Start({.tile_origin = "https://tile.example.org"});
  EXPECT_THAT(Exchange(kRequest), HasSubstr("connect-src 'self' https://tile.example.org; img-src 'self' data: blob: "
                                            "https://tile.example.org; media-src"));
}

TEST_F(HttpServerTest, AnswersOneAfterAnotherOnAConnection) {
  Start();
  const Client client(server_->port());
  const std::string port = std::to_string(server_->port());
  for (int i = 0; i < 3; ++i) {
    client.Send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
    const std::string answer = client.ReadUntil("\r\n\r\n" + port);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK"));
    EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff"));
    EXPECT_THAT(answer, HasSubstr("Content-Length: " + std::to_string(port.size())));
  }
  client.Send("GET /a HTTP/1.1\r\nHost: x\r\n\r\nGET /b HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(client.ReadAll(), EndsWith(port)) << "two requests sent at once";
  EXPECT_EQ(requests_, 5);
}

TEST_F(HttpServerTest, SendsPartsOfFiles) {
  std::string bytes(1'000'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 256);
  testing::WriteBytes(folder_ / "file.bin", bytes);
  Start();
  const std::string end = "\r\nConnection: close\r\n\r\n";
  const std::string whole = Exchange("GET /file HTTP/1.1\r\nHost: x" + end);
  EXPECT_EQ(whole.substr(whole.find("\r\n\r\n") + 4), bytes);
  const std::string part = Exchange("GET /file HTTP/1.1\r\nHost: x\r\nRange: bytes=300000-900000" + end);
  EXPECT_THAT(part, StartsWith("HTTP/1.1 206"));
  EXPECT_THAT(part, HasSubstr("Content-Range: bytes 300000-900000/1000000"));
  EXPECT_EQ(part.substr(part.find("\r\n\r\n") + 4), bytes.substr(300000, 600001));
  const std::string none = Exchange("GET /file HTTP/1.1\r\nHost: x\r\nRange: bytes=2000000-" + end);
  EXPECT_THAT(none, StartsWith("HTTP/1.1 416"));
  const std::string head = Exchange("HEAD /file HTTP/1.1\r\nHost: x" + end);
  EXPECT_THAT(head, HasSubstr("Content-Length: 1000000"));
  EXPECT_THAT(head, EndsWith("\r\n\r\n")) << "no body";
  EXPECT_THAT(Exchange("GET /gone HTTP/1.1\r\nHost: x" + end), StartsWith("HTTP/1.1 404"));
}

std::string Upload(std::string_view target, std::size_t length) {
  return "POST " + std::string(target) +
         " HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream\r\nConnection: close\r\nContent-Length: " +
         std::to_string(length) + "\r\n\r\n";
}

TEST_F(HttpServerTest, UploadsGoToAFile) {
  Start();
  std::string bytes(900'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 256);
  ASSERT_THAT(Exchange(Upload("/", bytes.size()) + bytes), EndsWith("kept 900000"));
  EXPECT_EQ(*ReadFile(folder_ / "upload1" / "file"), bytes);
  EXPECT_THAT(Exchange(Upload("/", 0)), EndsWith("kept 0"));
  // Chunked, as a stream of unknown length is sent.
  EXPECT_THAT(Exchange("POST / HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream\r\nConnection: close\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n3\r\n, x\r\n0\r\n\r\n"),
              EndsWith("kept 8"));
  EXPECT_EQ(*ReadFile(folder_ / "upload3" / "file"), "hello, x");
  // A client that asks first whether it may send.
  const Client asking(server_->port());
  std::string header = Upload("/", 3);
  header.insert(header.size() - 2, "Expect: 100-continue\r\n");
  asking.Send(header);
  EXPECT_THAT(asking.ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 100"));
  asking.Send("abc");
  EXPECT_THAT(asking.ReadAll(), EndsWith("kept 3"));
}

TEST_F(HttpServerTest, UploadsThatFailLeaveNoFile) {
  Start();
  EXPECT_THAT(Exchange(Upload("/refused", 10) + "0123456789"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(Exchange(Upload("/", 1'000'001)), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(Exchange("POST / HTTP/1.1\r\nHost: x\r\nContent-Type: application/octet-stream\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n1312D0\r\n" +
                       std::string(0x1312D0, 'x')),
              StartsWith("HTTP/1.1 413"))
      << "1.25 MB without saying so before";
  {
    const Client leaving(server_->port());
    leaving.Send(Upload("/", 1000) + "only a part");
  }
  EXPECT_THAT(Exchange(Upload("/late", 10) + "0123456789"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(Exchange(Upload("/", 1) + "x"), EndsWith("kept 1")) << "the server goes on";
  cancel_.Cancel();
  thread_.join();
  server_.reset();
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) ++entries;
  EXPECT_EQ(entries, 2) << "only the whole one, in its folder";
}

TEST_F(HttpServerTest, EventsComeUntilTheClientLeaves) {
  Start({.event_interval = std::chrono::milliseconds(5)});
  hub_->Publish("index", "1");
  {
    const Client client(server_->port());
    client.Send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(client.ReadUntil("\r\n\r\n"), HasSubstr("Content-Type: text/event-stream"));
    EXPECT_THAT(client.ReadUntil("\n\n"), EndsWith("event: index\ndata: 1\n\n"));
    for (int i = 0; i < 20; ++i) {
      hub_->Publish("jobs", std::to_string(i));
      EXPECT_THAT(client.ReadUntil("\n\n"), EndsWith("data: " + std::to_string(i) + "\n\n"));
    }
    EXPECT_EQ(hub_->listeners(), 1);
  }
  while (hub_->listeners() > 0) std::this_thread::yield();
}

TEST_F(HttpServerTest, SilenceIsFilledWithComments) {
  Start({.event_interval = std::chrono::milliseconds(1), .event_silence = std::chrono::milliseconds(5)});
  const Client client(server_->port());
  client.Send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(client.ReadUntil(":\n\n:\n\n"), EndsWith(":\n\n:\n\n"));
}

// So that who may listen is decided anew.
TEST_F(HttpServerTest, StreamsOfEventsEnd) {
  Start({.event_interval = std::chrono::milliseconds(1), .event_lifetime = std::chrono::milliseconds(20)});
  const Client client(server_->port());
  client.Send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(client.ReadAll(), HasSubstr("text/event-stream"));
  while (hub_->listeners() > 0) std::this_thread::yield();
}

TEST_F(HttpServerTest, HandlerGetsClientCookieAndToken) {
  Start();
  EXPECT_THAT(Exchange("GET /credentials HTTP/1.1\r\nHost: x\r\nConnection: close\r\nCookie: a=1\r\n"
                       "Authorization: Bearer b\r\n\r\n"),
              EndsWith("127.0.0.1|a=1|Bearer b"));
}

TEST_F(HttpServerTest, RefusesWhatIsTooLargeOrNoHttp) {
  Start({.max_header_bytes = 2000, .max_body_bytes = 100});
  EXPECT_THAT(Exchange("GET / HTTP/1.1\r\nX: " + std::string(3000, 'a') + "\r\n\r\n"), StartsWith("HTTP/1.1 431"));
  EXPECT_THAT(Exchange("PUT / HTTP/1.1\r\nHost: x\r\nContent-Length: 101\r\n\r\n" + std::string(101, 'a')),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(Exchange("PUT / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nffff\r\n" +
                       std::string(65535, 'a') + "\r\n0\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(Exchange("no HTTP at all\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(requests_, 0);
  EXPECT_THAT(Exchange("PUT / HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Length: 2\r\n\r\nok"),
              HasSubstr("\r\n\r\nok"));
}

// A proxy that sees another end of the first request passes the second one on as its own.
TEST_F(HttpServerTest, RefusesRequestsWithTwoMeanings) {
  Start({});
  const std::string next = "0\r\n\r\nGET /next HTTP/1.1\r\nHost: x\r\n\r\n";
  for (const char* const header :
       {"Transfer-Encoding: xchunked\r\n", "Transfer-Encoding: chunked, identity\r\n",
        "Transfer-Encoding: identity\r\nTransfer-Encoding: chunked\r\n", "Transfer-Encoding: gzip, chunked\r\n",
        "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n", "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n",
        "Content-Length: 5\r\nContent-Length: 6\r\n", "Host: y\r\n"}) {
    const std::string answer = Exchange(std::string("PUT / HTTP/1.1\r\nHost: x\r\n") + header + "\r\n" + next);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 400")) << header;
    EXPECT_EQ(answer.find("HTTP/1.1", 8), std::string::npos) << "the connection ends: " << header;
  }
  EXPECT_EQ(requests_, 0);
}

TEST_F(HttpServerTest, DropsSlowClients) {
  Start({.request_timeout = std::chrono::milliseconds(100), .first_timeout = std::chrono::milliseconds(100)});
  EXPECT_EQ(Exchange("GET / HTTP/1.1\r\nHost:"), "") << "a header that never ends";
  EXPECT_EQ(Exchange(""), "") << "no request";
  EXPECT_EQ(requests_, 0);
}

TEST_F(HttpServerTest, ServesManyConnections) {
  Start({.max_connections = 50});
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 49; ++i) idle.push_back(std::make_unique<Client>(server_->port()));
  EXPECT_THAT(Exchange("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  for (int i = 0; i < 20; ++i) idle.push_back(std::make_unique<Client>(server_->port()));
  const Client waiting(server_->port());
  waiting.Send("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  idle.clear();
  EXPECT_THAT(waiting.ReadAll(), StartsWith("HTTP/1.1 200")) << "accepted once others are gone";
}

TEST_F(HttpServerTest, OneClientLeavesRoomForOthers) {
  constexpr std::string_view kRequest = "GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n";
  Start({.max_connections = 8, .max_connections_a_client = 5});
  std::vector<std::unique_ptr<Client>> greedy;
  for (int i = 0; i < 25; ++i) greedy.push_back(std::make_unique<Client>(server_->port()));
  EXPECT_EQ(greedy[0]->ReadAll(), "") << "closed for a later one";
  const Client other(server_->port(), "127.0.0.2");
  other.Send(kRequest);
  EXPECT_THAT(other.ReadAll(), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Exchange(kRequest), StartsWith("HTTP/1.1 200"));
  std::vector<std::unique_ptr<Client>> busy;
  for (int i = 0; i < 5; ++i) {
    busy.push_back(std::make_unique<Client>(server_->port()));
    busy.back()->Send("GET /events HTTP/1.1\r\nHost: x\r\n\r\n");
    EXPECT_THAT(busy.back()->ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_EQ(Client(server_->port()).ReadAll(), "") << "closed at once: none of the five waits";
}

// From several addresses, with nothing, a part of a header, or a request that was answered.
TEST_F(HttpServerTest, IdleConnectionsLockNobodyOut) {
  Start({.max_connections = 6, .max_connections_a_client = 3});
  std::vector<std::unique_ptr<Client>> idle;
  for (const char* const from : {"127.0.0.1", "127.0.0.2"}) {
    for (const std::string_view sent : {"", "GET / HTTP/1.1\r\nHost:", "GET / HTTP/1.1\r\nHost: x\r\n\r\n"}) {
      idle.push_back(std::make_unique<Client>(server_->port(), from));
      idle.back()->Send(sent);
    }
    EXPECT_THAT(idle.back()->ReadUntil(std::to_string(server_->port())), StartsWith("HTTP/1.1 200"));
  }
  for (int i = 0; i < 10; ++i) {
    const Client other(server_->port(), "127.0.0.3");
    other.Send("GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(other.ReadAll(), StartsWith("HTTP/1.1 200"));
  }
}

TEST_F(HttpServerTest, EndsWithIdleConnectionsOpen) {
  Start();
  const Client idle(server_->port());
  idle.Send("GET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(idle.ReadUntil(std::to_string(server_->port())), StartsWith("HTTP/1.1 200"));
  cancel_.Cancel();
  thread_.join();
}

TEST_F(HttpServerTest, ReportsAPortInUse) {
  Start();
  HttpServerOptions options;
  options.port = server_->port();
  const auto second = HttpServer::Listen(options, [](const HttpRequest&, int) { return HttpResponse{}; });
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kConflict);
}

TEST(ListenAddress, SaysWhetherOtherMachinesReachIt) {
  EXPECT_EQ(ParseListenAddress("127.0.0.1:8080")->port, 8080);
  EXPECT_EQ(ParseListenAddress("localhost:0")->address, "127.0.0.1");
  EXPECT_EQ(ParseListenAddress("[::1]:80")->address, "::1");
  EXPECT_TRUE(ParseListenAddress("[::1]:80")->is_loopback);
  for (const char* text : {"0.0.0.0:8080", "[::]:8080", "192.0.2.1:8080"}) {
    EXPECT_FALSE(ParseListenAddress(text)->is_loopback) << text;
  }
  for (const char* text : {"", "8080", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:99999", "name:80"}) {
    EXPECT_THAT(ParseListenAddress(text).error().message, HasSubstr("as in 127.0.0.1:8080")) << text;
  }
}

}  // namespace
}  // namespace victorious
