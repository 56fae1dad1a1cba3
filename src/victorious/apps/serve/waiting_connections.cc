#include "victorious/apps/serve/waiting_connections.h"

#include <algorithm>

namespace victorious {

bool WaitingConnections::Close(Place place) {
  if (place == open_.end()) return false;
  const Connection closed = std::move(*place);
  open_.erase(place);
  closed.close();
  return true;
}

bool WaitingConnections::CloseOldest() { return Close(open_.begin()); }

bool WaitingConnections::CloseOldestOf(const std::string& client) {
  return Close(std::ranges::find(open_, client, &Connection::client));
}

}  // namespace victorious
