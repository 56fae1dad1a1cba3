// The open connections of each client, so that one which opens all that the server takes leaves room for others.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>

namespace victorious {

/// Whom connections are counted for: an IPv4 address, or of an IPv6 address its network of 64 bits, which a client has
/// for itself. A text that is no address is returned as it is.
[[nodiscard]] std::string ClientNetwork(const std::string& address);

/// Not thread-safe.
class ConnectionCount {
 public:
  explicit ConnectionCount(std::size_t max_a_client) : max_(max_a_client) {}

  [[nodiscard]] bool HasRoom(const std::string& address) const;
  /// Counts one more. Returns false if the client has too many, with a warning at most once a minute.
  /// @param has_place  one of its others is about to end
  [[nodiscard]] bool Begin(const std::string& address, bool has_place = false);
  void End(const std::string& address);

 private:
  std::size_t max_;
  std::unordered_map<std::string, std::size_t> open_;  ///< by network
  std::optional<std::chrono::steady_clock::time_point> warned_;
};

}  // namespace victorious
