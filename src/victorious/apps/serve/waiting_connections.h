// The connections that the server waits for: of which no whole header has come, or no next one. They are closed to make
// room for new connections, so that who opens many and sends nothing locks nobody out.
#pragma once

#include <functional>
#include <list>
#include <string>

namespace victorious {

/// Not thread-safe.
class WaitingConnections {
 public:
  struct Connection {
    std::string client;           ///< whose it is (ClientNetwork)
    std::function<void()> close;  ///< must not add or remove
  };
  using Place = std::list<Connection>::iterator;

  /// Returns its place, which is valid until it is removed or closed by one of these functions.
  [[nodiscard]] Place Add(Connection connection) { return open_.insert(open_.end(), std::move(connection)); }
  void Remove(Place place) { open_.erase(place); }

  /// Closes the one that waits for the longest time, and removes it. Returns false if there is none.
  [[nodiscard]] bool CloseOldest();
  /// The same, of a client.
  [[nodiscard]] bool CloseOldestOf(const std::string& client);

 private:
  bool Close(Place place);

  std::list<Connection> open_;  ///< the one that waits for the longest time first
};

}  // namespace victorious
