#include "victorious/apps/serve/client_stream.h"

#include <array>

#include <boost/asio/post.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <poll.h>

namespace victorious {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;
using BoostError = boost::system::error_code;
using tcp = net::ip::tcp;

class PlainStream final : public ClientStream {
 public:
  explicit PlainStream(beast::tcp_stream stream) : stream_(std::move(stream)) {}

  beast::tcp_stream& tcp() override { return stream_; }

  void Handshake(EndHandler handler) override { Succeed(std::move(handler)); }
  void SayFarewell(EndHandler handler) override { Succeed(std::move(handler)); }

  void WaitForLeaving(EndHandler handler) override {
    const auto ignored = net::buffer(ignored_);
    stream_.socket().async_read_some(
        ignored, [this, handler = std::move(handler)](const BoostError& error, std::size_t) mutable {
          if (error) return handler(error);
          WaitForLeaving(std::move(handler));
        });
  }

 private:
  void Succeed(EndHandler handler) {
    net::post(stream_.get_executor(), [handler = std::move(handler)]() mutable { handler({}); });
  }
  void ReadSome(std::vector<net::mutable_buffer> buffers, Handler handler) override {
    stream_.async_read_some(buffers, std::move(handler));
  }
  void WriteSome(std::vector<net::const_buffer> buffers, Handler handler) override {
    stream_.async_write_some(buffers, std::move(handler));
  }

  beast::tcp_stream stream_;
  std::array<char, 256> ignored_{};
};

class TlsStream final : public ClientStream {
 public:
  TlsStream(beast::tcp_stream stream, net::ssl::context& tls) : stream_(std::move(stream), tls) {}

  beast::tcp_stream& tcp() override { return stream_.next_layer(); }

  void Handshake(EndHandler handler) override {
    stream_.async_handshake(net::ssl::stream_base::server, std::move(handler));
  }
  void SayFarewell(EndHandler handler) override { stream_.async_shutdown(std::move(handler)); }
  void WaitForLeaving(EndHandler handler) override {
    tcp().socket().async_wait(tcp::socket::wait_read, std::move(handler));
  }

 private:
  void ReadSome(std::vector<net::mutable_buffer> buffers, Handler handler) override {
    stream_.async_read_some(buffers, std::move(handler));
  }
  void WriteSome(std::vector<net::const_buffer> buffers, Handler handler) override {
    stream_.async_write_some(buffers, std::move(handler));
  }

  beast::ssl_stream<beast::tcp_stream> stream_;
};

}  // namespace

bool ClientStream::HasLeft() {
  pollfd state{.fd = tcp().socket().native_handle(), .events = POLLRDHUP, .revents = 0};
  return ::poll(&state, 1, 0) != 0;
}

std::unique_ptr<ClientStream> MakeClientStream(beast::tcp_stream stream, net::ssl::context* tls) {
  if (tls != nullptr) return std::make_unique<TlsStream>(std::move(stream), *tls);
  return std::make_unique<PlainStream>(std::move(stream));
}

}  // namespace victorious
