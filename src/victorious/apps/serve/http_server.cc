#include "victorious/apps/serve/http_server.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/beast_message.h"
#include "victorious/apps/serve/client_stream.h"
#include "victorious/apps/serve/connection_count.h"
#include "victorious/apps/serve/open_file.h"
#include "victorious/apps/serve/request_guard.h"
#include "victorious/apps/serve/tls_certificate.h"
#include "victorious/apps/serve/upload_folder.h"
#include "victorious/apps/serve/waiting_connections.h"

namespace victorious {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace net = boost::asio;
namespace ssl = boost::asio::ssl;
using tcp = net::ip::tcp;
using BoostError = boost::system::error_code;

constexpr std::chrono::milliseconds kCancelPoll{50};
constexpr std::chrono::milliseconds kAcceptPause{100};
constexpr std::chrono::milliseconds kLeavingPoll{200};
constexpr std::chrono::seconds kFinishTime{2};
constexpr std::chrono::seconds kFarewellTime{2};

// Programs that this process starts would inherit the sockets that Asio opens. Those that base/child_start.h starts
// do not in any case.
void CloseInPrograms(int descriptor) { ::fcntl(descriptor, F_SETFD, FD_CLOEXEC); }

constexpr std::string_view kAmbiguous = "not an HTTP request: its end, or its host, is ambiguous";

boost::beast::string_view ToBeast(std::string_view text) { return {text.data(), text.size()}; }

// What all sessions share. Used by the thread of Run only.
struct Shared {
  HttpServerOptions options;
  HeaderList security_headers = SecurityHeaders(options.tile_origin, !options.tls_certificate.empty());
  HttpServer::Handler handler;
  HttpServer::UploadHandler plan_upload;
  int port = 0;
  std::size_t connections = 0;
  ConnectionCount counts;
  WaitingConnections waiting;
  std::size_t responses_due = 0;
  bool stopping = false;
  std::optional<ssl::context> tls;
  // Last: their destructors destroy the sessions.
  net::io_context io{1};
  WorkQueue slow;
  net::thread_pool pool;
  net::thread_pool slow_pool;

  Shared(const HttpServerOptions& given, HttpServer::Handler handle, HttpServer::UploadHandler plan)
      : options(given),
        handler(std::move(handle)),
        plan_upload(std::move(plan)),
        counts(given.max_connections_a_client),
        slow(given.slow, [this](auto run) { net::post(slow_pool, std::move(run)); }),
        pool(static_cast<std::size_t>(given.threads)),
        slow_pool(given.slow.threads) {}
};

// One connection: reads a request, lets the pool answer it, sends the response, and reads the next one.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// @param client  its address, which is counted; given back at the end
  Session(std::unique_ptr<ClientStream> stream, std::string client, Shared& shared)
      : stream_(std::move(stream)), shared_(shared), client_(std::move(client)), timer_(stream_->get_executor()) {
    ++shared_.connections;
  }
  ~Session() {
    StopWaiting();
    RemoveUpload();
    --shared_.connections;
    shared_.counts.End(client_);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void Start() {
    Wait();
    stream_->tcp().expires_after(shared_.options.first_timeout);
    stream_->Handshake([self = shared_from_this()](const BoostError& error) {
      if (error) return self->CloseSocket();
      self->has_handshake_ = true;
      self->Read(self->shared_.options.first_timeout);
    });
  }

 private:
  // From now on until the header has come, the connection may be closed to make room for another one.
  void Wait() {
    if (!place_) place_ = shared_.waiting.Add({ClientNetwork(client_), [this] { EndWaiting(); }});
  }
  void StopWaiting() {
    if (const auto place = std::exchange(place_, std::nullopt)) shared_.waiting.Remove(*place);
  }
  // Whoever reads from the socket then gets an error.
  void EndWaiting() {
    place_.reset();
    CloseSocket();
  }

  // Waits for the first byte of a request, then reads it under its own time-out.
  void Read(std::chrono::milliseconds idle_timeout) {
    Wait();
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(shared_.options.max_header_bytes));
    // Known once the header says what the body is. Not boost::none, which Beast 1.74 takes for 0 here.
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
    if (buffer_.size() > 0) return ReadRequest();
    stream_->tcp().expires_after(idle_timeout);
    stream_->async_read_some(buffer_.prepare(4096),
                             [self = shared_from_this()](const BoostError& error, std::size_t bytes) {
                               if (error) return self->Close();
                               self->buffer_.commit(bytes);
                               self->ReadRequest();
                             });
  }

  void ReadRequest() {
    stream_->tcp().expires_after(shared_.options.request_timeout);
    http::async_read_header(
        *stream_, buffer_, *parser_,
        [self = shared_from_this()](const BoostError& error, std::size_t) { self->OnHeader(error); });
  }

  void OnHeader(const BoostError& error) {
    StopWaiting();
    if (error) return Refuse(error);
    const auto& header = parser_->get();
    if (IsAmbiguous(header)) return SendLast(ErrorResponse(400, "bad_request", kAmbiguous));
    const bool is_upload = header.method() == http::verb::post && shared_.plan_upload &&
                           HeaderText(header, http::field::content_type) == "application/octet-stream";
    if (is_upload) return PlanUpload();
    if (parser_->content_length().value_or(0) > shared_.options.max_body_bytes) return Refuse(http::error::body_limit);
    parser_->body_limit(shared_.options.max_body_bytes);
    http::async_read(*stream_, buffer_, *parser_,
                     [self = shared_from_this()](const BoostError& failure, std::size_t) { self->OnRequest(failure); });
  }

  void OnRequest(const BoostError& error) {
    if (error) return Refuse(error);
    HttpRequest request = Begin(parser_->get());
    request.body = std::move(parser_->get().body());
    Answer(std::move(request));
  }

  HttpRequest Begin(const http::request<http::string_body>& message) {
    keep_alive_ = message.keep_alive();
    version_ = message.version();
    HttpRequest request = FromBeast(message);
    request.client = client_;
    is_head_ = request.method == HttpMethod::kHead;
    ++shared_.responses_due;
    stream_->tcp().expires_never();
    return request;
  }

  // Gives the session from the pool back to the thread of Run, which calls `go_on`. The pool keeps no reference: the
  // last one would run ~Session, which changes Shared.
  template <typename GoOn>
  static void GiveBack(std::shared_ptr<Session> self, GoOn go_on) {
    const auto executor = self->stream_->get_executor();
    net::post(executor, [self = std::move(self), go_on = std::move(go_on)]() mutable { go_on(*self); });
  }

  void Answer(HttpRequest request) {
    net::post(shared_.pool, [self = shared_from_this(), request = std::move(request)]() mutable {
      HttpResponse response = self->shared_.handler(request, self->shared_.port);
      // Its sender may have been logged out while it was read.
      if (request.upload && response.status != 200) UploadFolder::RemoveFile(*request.upload);
      GiveBack(std::move(self), [response = std::move(response)](Session& session) mutable {
        if (response.slow) return session.MakeSlowly(std::move(response.slow));
        session.Send(std::move(response));
      });
    });
  }

  // ---- a response that takes long

  void MakeSlowly(std::shared_ptr<SlowResponse> slow) {
    slow_left_ = std::make_shared<CancelToken>();
    const std::string client = slow->client;
    const bool is_queued =
        shared_.slow.Add({.client = client,
                          .left = slow_left_,
                          .run = [self = shared_from_this(), slow = std::move(slow), left = slow_left_]() mutable {
                            HttpResponse response = slow->make(*left);
                            GiveBack(std::move(self), [response = std::move(response)](Session& session) mutable {
                              session.SendMade(std::move(response));
                            });
                          }});
    if (is_queued) return WatchWhileSlow();
    slow_left_.reset();
    HttpResponse busy = ErrorResponse(503, Name(ErrorCode::kUnavailable),
                                      "the server decodes as many frames as it can: ask again in some seconds");
    busy.headers.emplace_back("Retry-After", kRetryAfter_s);
    Send(std::move(busy));
  }

  void SendMade(HttpResponse response) {
    slow_left_.reset();
    timer_.cancel();
    Send(std::move(response));
  }

  // What nobody waits for any more is not made.
  void WatchWhileSlow() {
    timer_.expires_after(kLeavingPoll);
    timer_.async_wait([self = shared_from_this()](const BoostError& error) {
      if (error || !self->slow_left_) return;
      if (!self->stream_->HasLeft()) return self->WatchWhileSlow();
      if (!self->shared_.slow.Cancel(self->slow_left_)) return;  // it is being made: SendMade comes
      self->slow_left_.reset();
      --self->shared_.responses_due;
      self->Close();
    });
  }

  // ---- a body that goes to a file

  void PlanUpload() {
    upload_request_ = Begin(parser_->get());
    net::post(shared_.pool, [self = shared_from_this()]() mutable {
      auto plan = self->shared_.plan_upload(self->upload_request_, self->shared_.port);
      GiveBack(std::move(self), [plan = std::move(plan)](Session& session) mutable {
        if (plan) return session.BeginUpload(*plan);
        session.keep_alive_ = false;  // its body is not read
        session.Send(std::move(plan.error()));
      });
    });
  }

  void BeginUpload(const UploadPlan& plan) {
    upload_.emplace(std::move(*parser_));
    parser_.reset();
    upload_->body_limit(plan.max_bytes);
    upload_request_.upload = plan.file;
    if (upload_->content_length().value_or(0) > plan.max_bytes) return FailUpload(http::error::body_limit);
    BoostError error;
    upload_->get().body().open(plan.file.c_str(), beast::file_mode::write_new, error);
    if (error) return FailUpload(500, "internal", "the upload cannot be written: " + error.message());
    if (beast::iequals(upload_->get()[http::field::expect], "100-continue")) return Continue();
    ReadUpload();
  }

  void Continue() {
    header_ = {};
    header_.version(version_);
    header_.result(http::status::continue_);
    stream_->tcp().expires_after(shared_.options.send_timeout);
    http::async_write(*stream_, header_, [self = shared_from_this()](const BoostError& error, std::size_t) {
      if (error) return self->FailUpload(error);
      self->ReadUpload();
    });
  }

  // In parts, so that the time-out is one of progress, not of the whole.
  void ReadUpload() {
    if (upload_->is_done()) {
      upload_->get().body().close();
      upload_.reset();
      stream_->tcp().expires_never();
      return Answer(std::exchange(upload_request_, {}));
    }
    stream_->tcp().expires_after(shared_.options.send_timeout);
    http::async_read_some(*stream_, buffer_, *upload_,
                          [self = shared_from_this()](const BoostError& error, std::size_t) {
                            if (error) return self->FailUpload(error);
                            self->ReadUpload();
                          });
  }

  void FailUpload(const BoostError& error) {
    if (error == http::error::body_limit) {
      return FailUpload(413, "body_too_large", "the file is larger than this server takes (--max-upload)");
    }
    if (error == boost::system::errc::no_space_on_device) {
      return FailUpload(507, "no_space", "no space left on the disk");
    }
    RemoveUpload();
    --shared_.responses_due;
    Close();
  }

  void FailUpload(int status, std::string_view code, std::string_view message) {
    RemoveUpload();
    keep_alive_ = false;
    Send(ErrorResponse(status, code, message));
  }

  void RemoveUpload() {
    upload_.reset();
    if (upload_request_.upload) UploadFolder::RemoveFile(*upload_request_.upload);
    upload_request_ = {};
  }

  // A request that cannot be parsed gets an answer if the client may still read one; the connection ends.
  void Refuse(const BoostError& error) {
    std::optional<HttpResponse> response =
        ResponseToUnread(error, shared_.options.max_header_bytes, shared_.options.max_body_bytes);
    if (!response) return Close();
    SendLast(*std::move(response));
  }

  void SendLast(HttpResponse response) {
    keep_alive_ = false;
    version_ = 11;
    is_head_ = false;
    ++shared_.responses_due;
    Send(std::move(response));
  }

  template <typename Body>
  void SetHeader(http::response<Body>& message, const HttpResponse& response, std::optional<std::uint64_t> length) {
    message.version(version_);
    message.result(static_cast<unsigned>(response.status));
    message.set(http::field::server, "victorious");
    if (!response.content_type.empty()) message.set(http::field::content_type, response.content_type);
    for (const auto& [name, value] : response.headers) message.insert(ToBeast(name), ToBeast(value));
    for (const auto& [name, value] : shared_.security_headers) message.insert(ToBeast(name), ToBeast(value));
    if (shared_.stopping) keep_alive_ = false;
    message.keep_alive(keep_alive_);
    if (length && response.status != 304 && response.status != 204) message.content_length(*length);
  }

  // ---- a stream of events

  void SendEvents(HttpResponse response) {
    feed_ = std::move(response.events);
    header_ = {};
    keep_alive_ = false;
    SetHeader(header_, response, std::nullopt);
    serializer_.emplace(header_);
    stream_->tcp().expires_after(shared_.options.send_timeout);
    http::async_write_header(*stream_, *serializer_, [self = shared_from_this()](const BoostError& error, std::size_t) {
      --self->shared_.responses_due;  // it never ends: the server's end does not wait for it
      if (error || self->is_head_) return self->Close();
      self->stream_->tcp().expires_never();
      self->WatchForLeaving();
      self->last_event_ = std::chrono::steady_clock::now();
      self->events_end_ = self->last_event_ + self->shared_.options.event_lifetime;
      self->SendNextEvents();
    });
  }

  // A client that leaves is noticed although nothing is sent to it.
  void WatchForLeaving() {
    stream_->WaitForLeaving([self = shared_from_this()](const BoostError&) {
      self->feed_.reset();
      self->timer_.cancel();
    });
  }

  void SendNextEvents() {
    const auto now = std::chrono::steady_clock::now();
    if (!feed_ || shared_.stopping || now > events_end_) return Close();
    text_to_send_ = feed_->Take();
    if (text_to_send_.empty() && now - last_event_ >= shared_.options.event_silence) text_to_send_ = ":\n\n";
    if (text_to_send_.empty()) {
      timer_.expires_after(shared_.options.event_interval);
      timer_.async_wait([self = shared_from_this()](const BoostError&) { self->SendNextEvents(); });
      return;
    }
    last_event_ = now;
    stream_->tcp().expires_after(shared_.options.send_timeout);
    net::async_write(*stream_, net::buffer(text_to_send_),
                     [self = shared_from_this()](const BoostError& error, std::size_t) {
                       if (error) return self->Close();
                       self->stream_->tcp().expires_never();
                       self->SendNextEvents();
                     });
  }

  void Send(HttpResponse response) {
    if (response.events) return SendEvents(std::move(response));
    if (response.file) {
      file_.emplace(*response.file);
      if (!file_->is_open()) {
        file_.reset();
        response = ErrorResponse(404, "not_found", response.file->path.filename().string() + ": cannot be read");
      }
    }
    const std::uint64_t length =
        file_ ? static_cast<std::uint64_t>(response.file->length) : static_cast<std::uint64_t>(response.body.size());
    text_ = {};
    SetHeader(text_, response, length);
    stream_->tcp().expires_after(shared_.options.send_timeout);
    if (!file_ && !is_head_) {
      text_.body() = std::move(response.body);
      http::async_write(*stream_, text_,
                        [self = shared_from_this()](const BoostError& error, std::size_t) { self->Finish(error); });
      return;
    }
    header_ = {};
    SetHeader(header_, response, length);
    serializer_.emplace(header_);
    http::async_write_header(*stream_, *serializer_, [self = shared_from_this()](const BoostError& error, std::size_t) {
      if (error || self->is_head_ || !self->file_) return self->Finish(error);
      self->SendChunk();
    });
  }

  void SendChunk() {
    if (file_->left() == 0) return Finish({});
    // The length is sent already: a file that became shorter can only end the connection.
    if (!file_->ReadChunk(chunk_)) return Finish(net::error::eof);
    stream_->tcp().expires_after(shared_.options.send_timeout);
    net::async_write(*stream_, net::buffer(chunk_), [self = shared_from_this()](const BoostError& error, std::size_t) {
      if (error) return self->Finish(error);
      self->SendChunk();
    });
  }

  void Finish(const BoostError& error) {
    --shared_.responses_due;
    file_.reset();
    if (error || !keep_alive_ || shared_.stopping) return Close();
    Read(shared_.options.idle_timeout);
  }

  void Close() {
    if (!std::exchange(has_handshake_, false)) return CloseSocket();
    stream_->tcp().expires_after(kFarewellTime);
    stream_->SayFarewell([self = shared_from_this()](const BoostError&) { self->CloseSocket(); });
  }

  void CloseSocket() {
    BoostError ignored;
    stream_->tcp().socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_->tcp().close();
  }

  std::unique_ptr<ClientStream> stream_;
  Shared& shared_;
  std::string client_;
  std::optional<WaitingConnections::Place> place_;  ///< while it waits for a header
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::request_parser<http::file_body>> upload_;
  HttpRequest upload_request_;
  net::steady_timer timer_;
  std::shared_ptr<EventFeed> feed_;
  std::string text_to_send_;
  std::shared_ptr<CancelToken> slow_left_;  ///< of the response that is made slowly; null: there is none
  std::chrono::steady_clock::time_point last_event_;
  std::chrono::steady_clock::time_point events_end_;
  bool has_handshake_ = false;
  bool keep_alive_ = false;
  bool is_head_ = false;
  unsigned version_ = 11;
  http::response<http::string_body> text_;
  http::response<http::empty_body> header_;
  std::optional<http::response_serializer<http::empty_body>> serializer_;
  std::optional<OpenFile> file_;
  std::vector<char> chunk_;
};

class BeastServer final : public HttpServer {
 public:
  BeastServer(const HttpServerOptions& options, Handler handler, UploadHandler plan_upload)
      : shared_(options, std::move(handler), std::move(plan_upload)),
        acceptor_(shared_.io),
        pause_(shared_.io),
        poll_(shared_.io) {}

  Status Bind() {
    const HttpServerOptions& options = shared_.options;
    if (!options.tls_certificate.empty()) {
      shared_.tls.emplace(ssl::context::tls_server);
      VICTORIOUS_RETURN_IF_ERROR(LoadCertificate(options.tls_certificate, options.tls_key, *shared_.tls));
    }
    BoostError error;
    const auto address = net::ip::make_address(options.address, error);
    const std::string name = fmt::format("{}:{}", options.address, options.port);
    if (error) return Fail(ErrorCode::kInvalidArgument, name + ": not an address");
    const tcp::endpoint endpoint(address, static_cast<std::uint16_t>(options.port));
    acceptor_.open(endpoint.protocol(), error);
    if (!error) CloseInPrograms(acceptor_.native_handle());
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (error == net::error::address_in_use) {
      return Fail(ErrorCode::kConflict, name +
                                            ": another program has this port: give another one, as --listen "
                                            "127.0.0.1:8081, or 0 for any free one");
    }
    if (error) return std::unexpected(ErrorFromErrno(error.value(), "listen on " + name));
    shared_.port = acceptor_.local_endpoint().port();
    return {};
  }

  [[nodiscard]] int port() const override { return shared_.port; }

  void Run(const CancelToken& cancel) override {
    Accept();
    PollCancel(cancel);
    shared_.io.run();
    shared_.slow.CancelAll();
    shared_.pool.join();
    shared_.slow_pool.join();
  }

 private:
  void Begin(tcp::socket socket) {
    CloseInPrograms(socket.native_handle());
    BoostError error;
    const auto peer = socket.remote_endpoint(error);
    if (error) return;  // it has left already
    std::string client = peer.address().to_string();
    // What is closed counts until its handlers have run: the client has one more meanwhile.
    const bool has_place = !shared_.counts.HasRoom(client) && shared_.waiting.CloseOldestOf(ClientNetwork(client));
    if (!shared_.counts.Begin(client, has_place)) return;
    socket.set_option(tcp::no_delay(true), error);
    beast::tcp_stream stream(std::move(socket));
    std::make_shared<Session>(MakeClientStream(std::move(stream), shared_.tls ? &*shared_.tls : nullptr),
                              std::move(client), shared_)
        ->Start();
  }

  void Accept() {
    acceptor_.async_accept([this](const BoostError& error, tcp::socket socket) {
      if (shared_.stopping) return;
      if (!error) Begin(std::move(socket));
      if (!error && (HasRoom() || shared_.waiting.CloseOldest())) return Accept();
      // All are answered at the moment, or there is no descriptor for another one.
      PauseAccepting();
    });
  }

  [[nodiscard]] bool HasRoom() const { return shared_.connections < shared_.options.max_connections; }

  void PauseAccepting() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([this](const BoostError&) {
      if (shared_.stopping) return;
      if (HasRoom()) return Accept();
      PauseAccepting();
    });
  }

  void PollCancel(const CancelToken& cancel) {
    poll_.expires_after(kCancelPoll);
    poll_.async_wait([this, &cancel](const BoostError&) {
      if (!cancel.IsCancelled()) return PollCancel(cancel);
      if (!shared_.stopping) {
        shared_.stopping = true;
        stop_at_ = std::chrono::steady_clock::now() + kFinishTime;
        BoostError ignored;
        acceptor_.close(ignored);
      }
      // Idle connections are dropped, responses are finished.
      if (shared_.responses_due == 0 || std::chrono::steady_clock::now() >= stop_at_) return shared_.io.stop();
      PollCancel(cancel);
    });
  }

  Shared shared_;
  tcp::acceptor acceptor_;
  net::steady_timer pause_;
  net::steady_timer poll_;
  std::chrono::steady_clock::time_point stop_at_;
};

}  // namespace

Expected<std::unique_ptr<HttpServer>> HttpServer::Listen(const HttpServerOptions& options, Handler handler,
                                                         UploadHandler plan_upload) {
  auto server = std::make_unique<BeastServer>(options, std::move(handler), std::move(plan_upload));
  VICTORIOUS_RETURN_IF_ERROR(server->Bind());
  return server;
}

}  // namespace victorious
