// Sockets of 127.0.0.1 for tests, and a server that sends given bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <string>
#include <thread>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "victorious/base/check.h"

namespace victorious::testing {

inline sockaddr_in Loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

inline int BindToFreePort(int socket) {
  sockaddr_in address = Loopback(0);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  VICTORIOUS_CHECK(::bind(socket, generic, size) == 0);
  VICTORIOUS_CHECK(::getsockname(socket, generic, &size) == 0);
  return ntohs(address.sin_port);
}

inline int FreeUdpPort() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  const int port = BindToFreePort(socket);
  ::close(socket);
  return port;
}

// A TCP server for one connection, on a free port of 127.0.0.1.
class LoopbackServer {
 public:
  LoopbackServer() : socket_(::socket(AF_INET, SOCK_STREAM, 0)), port_(BindToFreePort(socket_)) {
    VICTORIOUS_CHECK(::listen(socket_, 1) == 0);
  }
  ~LoopbackServer() {
    stop_.set_value();
    ::shutdown(socket_, SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
    ::close(socket_);
  }
  LoopbackServer(const LoopbackServer&) = delete;
  LoopbackServer& operator=(const LoopbackServer&) = delete;

  /// Accepts in the background, sends `bytes`, then keeps the connection open without sending for `silent_s`.
  void Serve(std::string bytes, double silent_s) {
    if (thread_.joinable()) thread_.join();
    stop_ = {};
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
  int port_;
  std::promise<void> stop_;
  std::thread thread_;
};

}  // namespace victorious::testing
