// serve/, the bytes of one connection, plain or encrypted by TLS: what http_server.cc reads and writes. An asynchronous
// stream as Boost.Beast asks for it. Buffers and handlers have one type each, so that Beast's operations are compiled
// once, and not for each kind of stream and each handler.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>

namespace victorious {

/// Used by one thread. A handler is called later by the executor, never by the call that it is given to.
class ClientStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;
  using Handler = std::move_only_function<void(boost::system::error_code, std::size_t bytes)>;
  using EndHandler = std::move_only_function<void(boost::system::error_code)>;

  virtual ~ClientStream() = default;
  ClientStream(const ClientStream&) = delete;
  ClientStream& operator=(const ClientStream&) = delete;

  [[nodiscard]] executor_type get_executor() { return tcp().get_executor(); }

  template <typename Buffers, typename ReadHandler>
  void async_read_some(const Buffers& buffers, ReadHandler&& handler) {
    ReadSome({boost::asio::buffer_sequence_begin(buffers), boost::asio::buffer_sequence_end(buffers)},
             std::forward<ReadHandler>(handler));
  }

  template <typename Buffers, typename WriteHandler>
  void async_write_some(const Buffers& buffers, WriteHandler&& handler) {
    WriteSome({boost::asio::buffer_sequence_begin(buffers), boost::asio::buffer_sequence_end(buffers)},
              std::forward<WriteHandler>(handler));
  }

  /// Whether the client has closed its end, also if it has sent more before. Reads nothing. Some microseconds.
  [[nodiscard]] bool HasLeft();

  /// The socket and its time-outs.
  [[nodiscard]] virtual boost::beast::tcp_stream& tcp() = 0;

  /// Before the first byte; the handler of a plain stream is called without an error.
  virtual void Handshake(EndHandler handler) = 0;

  /// Says farewell, as TLS asks for; the socket stays open. After the handshake.
  virtual void SayFarewell(EndHandler handler) = 0;

  /// Calls the handler once the client has left. Nothing else reads until then. A client that has nothing to say: any
  /// byte of a TLS client is taken for its farewell, and those of a plain one are ignored.
  virtual void WaitForLeaving(EndHandler handler) = 0;

 protected:
  ClientStream() = default;

 private:
  virtual void ReadSome(std::vector<boost::asio::mutable_buffer> buffers, Handler handler) = 0;
  virtual void WriteSome(std::vector<boost::asio::const_buffer> buffers, Handler handler) = 0;
};

/// @param tls  null: plain; must outlive the stream
[[nodiscard]] std::unique_ptr<ClientStream> MakeClientStream(boost::beast::tcp_stream stream,
                                                             boost::asio::ssl::context* tls);

}  // namespace victorious
