#include "victorious/apps/serve/connection_count.h"

#include <algorithm>
#include <array>

#include <arpa/inet.h>

#include "victorious/base/log.h"

namespace victorious {
namespace {

constexpr std::size_t kNetworkBytes = 8;

}  // namespace

std::string ClientNetwork(const std::string& address) {
  in6_addr v6{};
  const std::string plain = address.substr(0, address.find('%'));  // without the name of the interface
  if (::inet_pton(AF_INET6, plain.c_str(), &v6) != 1) return address;
  if (IN6_IS_ADDR_V4MAPPED(&v6)) return plain.substr(plain.rfind(':') + 1);
  std::fill(std::begin(v6.s6_addr) + kNetworkBytes, std::end(v6.s6_addr), 0);
  std::array<char, INET6_ADDRSTRLEN> text{};
  return ::inet_ntop(AF_INET6, &v6, text.data(), text.size()) == nullptr ? address : text.data();
}

bool ConnectionCount::HasRoom(const std::string& address) const {
  const auto counted = open_.find(ClientNetwork(address));
  return counted == open_.end() ? max_ > 0 : counted->second < max_;
}

bool ConnectionCount::Begin(const std::string& address, bool has_place) {
  const std::string client = ClientNetwork(address);
  std::size_t& open = open_[client];
  if (open < max_ || has_place) {
    ++open;
    return true;
  }
  const auto now = std::chrono::steady_clock::now();
  if (!warned_ || now - *warned_ >= std::chrono::minutes(1)) {
    warned_ = now;
    LogWarning("{} has {} connections: further ones are closed", client, open);
  }
  return false;
}

void ConnectionCount::End(const std::string& address) {
  const auto counted = open_.find(ClientNetwork(address));
  if (counted != open_.end() && --counted->second == 0) open_.erase(counted);
}

}  // namespace victorious
