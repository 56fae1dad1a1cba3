// An HTTP/1.1 server (Boost.Beast): limits, time-outs, keep-alive, TLS (OpenSSL), files in parts. The handler makes the
// responses.
//
// One thread (that of Run) does all input and output; a pool of threads runs the handler. What takes long, as to decode
// a frame, waits in a queue for threads of its own (work_queue.h), so that it holds up no other request; if the queue
// is full, the response is 503 with Retry-After. Boost does not leave http_server.cc.
#pragma once

#include <chrono>
#include <cstddef>
#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "victorious/apps/serve/http_message.h"
#include "victorious/apps/serve/work_queue.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

struct HttpServerOptions {
  std::string address = "127.0.0.1";      ///< IPv4 or IPv6, numeric
  bool is_loopback = true;                ///< of the address: other machines do not reach it
  int port = 8080;                        ///< 0: any free one
  std::filesystem::path tls_certificate;  ///< PEM, with those that issued it; empty: no TLS
  std::filesystem::path tls_key;          ///< PEM, not encrypted
  std::string tile_origin;                ///< of a server of map tiles that the page may ask; empty: none
  int threads = 8;                        ///< that run the handler
  WorkLimits slow;                        ///< of responses that take long
  /// Further ones take the place of the one that waits for its next request for the longest time, or wait themselves.
  std::size_t max_connections = 900;
  /// The same; they are closed if none waits. So one client leaves room for others.
  std::size_t max_connections_a_client = 150;
  std::size_t max_header_bytes = 16 << 10;
  std::size_t max_body_bytes = 64 << 10;
  std::chrono::milliseconds request_timeout{15'000};  ///< from a request's first byte to its last
  std::chrono::milliseconds first_timeout{5'000};     ///< to the first byte of the first request, and for a handshake
  std::chrono::milliseconds idle_timeout{60'000};     ///< between requests
  std::chrono::milliseconds send_timeout{60'000};     ///< without progress; also of an upload
  std::chrono::milliseconds event_interval{100};      ///< between looks for events
  std::chrono::milliseconds event_silence{15'000};    ///< after which a comment keeps a stream of events alive
  /// Of a stream of events. The browser opens the next one by itself, and is admitted again or not.
  std::chrono::milliseconds event_lifetime{300'000};
};

/// Parses "ADDRESS:PORT"; "[::1]:8080" for IPv6. Error: kInvalidArgument.
[[nodiscard]] Expected<HttpServerOptions> ParseListenAddress(const std::string& text);

class HttpServer {
 public:
  /// Called from several threads at once, with the server's port. Must not throw.
  using Handler = std::function<HttpResponse(const HttpRequest& request, int port)>;

  /// Asked before the body of a POST request with the content type
  /// application/octet-stream is read: where it goes, or the response that
  /// refuses it. Called from several threads at once. Must not throw.
  using UploadHandler = std::function<std::expected<UploadPlan, HttpResponse>(const HttpRequest& request, int port)>;

  /// @param plan_upload  empty: no uploads
  /// Binds the port. Errors: kConflict if another program has it;
  /// kPermissionDenied; kNotFound and kInvalidArgument, also for a certificate and key that do not belong together.
  [[nodiscard]] static Expected<std::unique_ptr<HttpServer>> Listen(const HttpServerOptions& options, Handler handler,
                                                                    UploadHandler plan_upload = {});

  virtual ~HttpServer() = default;

  [[nodiscard]] virtual int port() const = 0;

  /// Serves until `cancel`; responses that were begun are then finished, for at most two seconds.
  virtual void Run(const CancelToken& cancel) = 0;
};

}  // namespace victorious
