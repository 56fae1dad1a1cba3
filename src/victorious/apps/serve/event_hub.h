// Server-sent events (HTML Living Standard, section 9.2): what changes, told to
// every open page. Thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// Keeps the latest event of each name, which a new listener gets first, and a
/// bounded tail of all events for listeners that are slower.
class EventHub : public std::enable_shared_from_this<EventHub> {
 public:
  /// @param json  one line
  void Publish(std::string_view name, std::string_view json);

  /// A listener from now on. It keeps the hub alive.
  [[nodiscard]] std::shared_ptr<EventFeed> Listen();

  [[nodiscard]] int listeners() const;

 private:
  class Listener;

  struct Event {
    std::int64_t number = 0;
    std::string text;  ///< on the wire
  };

  static constexpr std::size_t kKept = 256;

  mutable std::mutex mutex_;
  std::int64_t next_ = 1;
  int listeners_ = 0;
  std::deque<Event> tail_;
  std::map<std::string, Event, std::less<>> latest_;  ///< by name
};

}  // namespace victorious
