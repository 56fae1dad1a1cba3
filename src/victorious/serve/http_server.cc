#include "victorious/serve/http_server.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/version.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "victorious/serve/api_error.h"

namespace victorious {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace net = boost::asio;
using tcp = net::ip::tcp;
using BoostError = boost::system::error_code;

constexpr std::chrono::milliseconds kCancelPoll{50};
constexpr std::chrono::milliseconds kAcceptPause{100};
constexpr std::chrono::seconds kFinishTime{2};
constexpr std::size_t kFileChunkBytes = std::size_t{256} << 10;

// What browsers are told about every response: no content type by guess, no frame, nothing from elsewhere.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kSecurityHeaders = {{
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Content-Security-Policy",
     "default-src 'self'; img-src 'self' data: blob:; media-src 'self' blob:; worker-src 'self' blob:; "
     "style-src 'self' 'unsafe-inline'; object-src 'none'; base-uri 'none'; frame-ancestors 'none'"},
}};

boost::beast::string_view ToBeast(std::string_view text) { return {text.data(), text.size()}; }

std::string Header(const http::request<http::string_body>& request, http::field field) {
  const auto value = request[field];
  return {value.data(), value.size()};
}

HttpRequest FromBeast(http::request<http::string_body>&& request) {
  HttpRequest plain;
  switch (request.method()) {
    case http::verb::get:
      plain.method = HttpMethod::kGet;
      break;
    case http::verb::head:
      plain.method = HttpMethod::kHead;
      break;
    case http::verb::put:
      plain.method = HttpMethod::kPut;
      break;
    default:
      plain.method = HttpMethod::kOther;
  }
  plain.target = std::string(request.target().data(), request.target().size());
  plain.host = Header(request, http::field::host);
  plain.origin = Header(request, http::field::origin);
  const auto site = request["Sec-Fetch-Site"];
  plain.fetch_site = std::string(site.data(), site.size());
  plain.content_type = Header(request, http::field::content_type);
  plain.range = Header(request, http::field::range);
  plain.if_range = Header(request, http::field::if_range);
  plain.if_none_match = Header(request, http::field::if_none_match);
  plain.body = std::move(request.body());
  return plain;
}

// A file that is being sent. Closes it.
class OpenFile {
 public:
  explicit OpenFile(const FileSlice& slice)
      : descriptor_(::open(slice.path.c_str(), O_RDONLY | O_CLOEXEC)), offset_(slice.offset), left_(slice.length) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }
  [[nodiscard]] std::int64_t left() const { return left_; }

  // Reads the next chunk. Returns false if the file ended early or cannot be read.
  bool ReadChunk(std::vector<char>& chunk) {
    chunk.resize(static_cast<std::size_t>(std::min<std::int64_t>(left_, kFileChunkBytes)));
    ssize_t got = 0;
    do {
      got = ::pread(descriptor_, chunk.data(), chunk.size(), offset_);
    } while (got < 0 && errno == EINTR);
    if (got <= 0) return false;
    chunk.resize(static_cast<std::size_t>(got));
    offset_ += got;
    left_ -= got;
    return true;
  }

 private:
  int descriptor_;
  std::int64_t offset_;
  std::int64_t left_;
};

// What all sessions share. Used by the thread of Run only.
struct Shared {
  HttpServerOptions options;
  HttpServer::Handler handler;
  int port = 0;
  std::size_t connections = 0;
  std::size_t responses_due = 0;
  bool stopping = false;
  // Last: their destructors destroy the sessions.
  net::io_context io{1};
  net::thread_pool pool;

  Shared(const HttpServerOptions& given, HttpServer::Handler handle)
      : options(given), handler(std::move(handle)), pool(static_cast<std::size_t>(given.threads)) {}
};

// One connection: reads a request, lets the pool answer it, sends the response, and reads the next one.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(tcp::socket&& socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) { ++shared_.connections; }
  ~Session() { --shared_.connections; }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Waits for the first byte of a request, then reads it under its own time-out.
  void Read() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(shared_.options.max_header_bytes));
    parser_->body_limit(shared_.options.max_body_bytes);
    if (buffer_.size() > 0) return ReadRequest();
    stream_.expires_after(shared_.options.idle_timeout);
    stream_.async_read_some(buffer_.prepare(4096),
                            [self = shared_from_this()](const BoostError& error, std::size_t bytes) {
                              if (error) return self->Close();
                              self->buffer_.commit(bytes);
                              self->ReadRequest();
                            });
  }

 private:
  void ReadRequest() {
    stream_.expires_after(shared_.options.request_timeout);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](const BoostError& error, std::size_t) { self->OnRequest(error); });
  }

  void OnRequest(const BoostError& error) {
    if (error) return Refuse(error);
    keep_alive_ = parser_->get().keep_alive();
    version_ = parser_->get().version();
    HttpRequest request = FromBeast(parser_->release());
    is_head_ = request.method == HttpMethod::kHead;
    ++shared_.responses_due;
    stream_.expires_never();
    net::post(shared_.pool, [self = shared_from_this(), request = std::move(request)]() mutable {
      HttpResponse response = self->shared_.handler(request, self->shared_.port);
      net::post(self->stream_.get_executor(),
                [self, response = std::move(response)]() mutable { self->Send(std::move(response)); });
    });
  }

  // A request that cannot be parsed gets an answer if the client may still read one; the connection ends.
  void Refuse(const BoostError& error) {
    std::optional<HttpResponse> response;
    if (error == http::error::body_limit) {
      response = ErrorResponse(413, "body_too_large",
                               fmt::format("the body has more than {} bytes", shared_.options.max_body_bytes));
    } else if (error == http::error::header_limit) {
      response = ErrorResponse(431, "header_too_large",
                               fmt::format("the header has more than {} bytes", shared_.options.max_header_bytes));
    } else if (error == beast::error::timeout) {
      return Close();
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      response = ErrorResponse(400, "bad_request", "not an HTTP request: " + error.message());
    }
    if (!response) return Close();
    keep_alive_ = false;
    version_ = 11;
    is_head_ = false;
    ++shared_.responses_due;
    Send(*std::move(response));
  }

  template <typename Body>
  void SetHeader(http::response<Body>& message, const HttpResponse& response, std::uint64_t length) {
    message.version(version_);
    message.result(static_cast<unsigned>(response.status));
    message.set(http::field::server, "victorious");
    if (!response.content_type.empty()) message.set(http::field::content_type, response.content_type);
    for (const auto& [name, value] : response.headers) message.insert(ToBeast(name), ToBeast(value));
    for (const auto& [name, value] : kSecurityHeaders) message.insert(ToBeast(name), ToBeast(value));
    if (shared_.stopping) keep_alive_ = false;
    message.keep_alive(keep_alive_);
    if (response.status != 304 && response.status != 204) message.content_length(length);
  }

  void Send(HttpResponse response) {
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
    stream_.expires_after(shared_.options.send_timeout);
    if (!file_ && !is_head_) {
      text_.body() = std::move(response.body);
      http::async_write(stream_, text_,
                        [self = shared_from_this()](const BoostError& error, std::size_t) { self->Finish(error); });
      return;
    }
    header_ = {};
    SetHeader(header_, response, length);
    serializer_.emplace(header_);
    http::async_write_header(stream_, *serializer_, [self = shared_from_this()](const BoostError& error, std::size_t) {
      if (error || self->is_head_ || !self->file_) return self->Finish(error);
      self->SendChunk();
    });
  }

  void SendChunk() {
    if (file_->left() == 0) return Finish({});
    // The length is sent already: a file that became shorter can only end the connection.
    if (!file_->ReadChunk(chunk_)) return Finish(net::error::eof);
    stream_.expires_after(shared_.options.send_timeout);
    net::async_write(stream_, net::buffer(chunk_), [self = shared_from_this()](const BoostError& error, std::size_t) {
      if (error) return self->Finish(error);
      self->SendChunk();
    });
  }

  void Finish(const BoostError& error) {
    --shared_.responses_due;
    file_.reset();
    if (error || !keep_alive_ || shared_.stopping) return Close();
    Read();
  }

  void Close() {
    BoostError ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.close();
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
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
  BeastServer(const HttpServerOptions& options, Handler handler)
      : shared_(options, std::move(handler)), acceptor_(shared_.io), pause_(shared_.io), poll_(shared_.io) {}

  Status Bind() {
    const HttpServerOptions& options = shared_.options;
    BoostError error;
    const auto address = net::ip::make_address(options.address, error);
    const std::string name = fmt::format("{}:{}", options.address, options.port);
    if (error) return Fail(ErrorCode::kInvalidArgument, name + ": not an address");
    const tcp::endpoint endpoint(address, static_cast<std::uint16_t>(options.port));
    acceptor_.open(endpoint.protocol(), error);
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
    shared_.pool.join();
  }

 private:
  void Accept() {
    acceptor_.async_accept([this](const BoostError& error, tcp::socket socket) {
      if (shared_.stopping) return;
      if (!error) {
        socket.set_option(tcp::no_delay(true));
        std::make_shared<Session>(std::move(socket), shared_)->Read();
      }
      // Too many connections, or no descriptor for another: those that wait are accepted when one ends.
      if (!error && shared_.connections < shared_.options.max_connections) return Accept();
      PauseAccepting();
    });
  }

  void PauseAccepting() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([this](const BoostError&) {
      if (shared_.stopping) return;
      if (shared_.connections < shared_.options.max_connections) return Accept();
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

Expected<HttpServerOptions> ParseListenAddress(const std::string& text) {
  HttpServerOptions options;
  const std::size_t colon = text.rfind(':');
  std::string address = text.substr(0, std::min(colon, text.size()));
  if (address.size() > 2 && address.front() == '[' && address.back() == ']') {
    address = address.substr(1, address.size() - 2);
  }
  const std::string_view port =
      colon == std::string::npos ? std::string_view() : std::string_view(text).substr(colon + 1);
  const auto [end, port_error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  const bool is_port =
      port_error == std::errc() && end == port.data() + port.size() && options.port >= 0 && options.port <= 65535;
  if (address == "localhost") address = "127.0.0.1";
  BoostError error;
  const auto ip = net::ip::make_address(address, error);
  if (!is_port || error) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--listen \"{}\": must be an address and a port, as in 127.0.0.1:8080", text));
  }
  if (!ip.is_loopback()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--listen \"{}\": only a loopback address (127.0.0.1, [::1]) is served: there are no "
                            "accounts, so other machines must not reach it; use an SSH tunnel from there",
                            text));
  }
  options.address = ip.to_string();
  return options;
}

Expected<std::unique_ptr<HttpServer>> HttpServer::Listen(const HttpServerOptions& options, Handler handler) {
  auto server = std::make_unique<BeastServer>(options, std::move(handler));
  VICTORIOUS_RETURN_IF_ERROR(server->Bind());
  return server;
}

}  // namespace victorious
