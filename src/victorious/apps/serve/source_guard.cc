#include "victorious/apps/serve/source_guard.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "victorious/base/text.h"

namespace victorious {
namespace {

bool IsForbidden(std::uint32_t v4) {
  const std::uint32_t first = v4 >> 24;
  return first == 0 || first == 127 || v4 >> 16 == 0xA9FE;  // 169.254.0.0/16
}

bool IsForbidden(const sockaddr& address) {
  if (address.sa_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &address, sizeof v4);
    return IsForbidden(ntohl(v4.sin_addr.s_addr));
  }
  if (address.sa_family != AF_INET6) return true;
  sockaddr_in6 v6{};
  std::memcpy(&v6, &address, sizeof v6);
  const in6_addr& bytes = v6.sin6_addr;
  if (IN6_IS_ADDR_V4MAPPED(&bytes) || IN6_IS_ADDR_V4COMPAT(&bytes)) {
    std::uint32_t v4 = 0;
    std::memcpy(&v4, bytes.s6_addr + 12, sizeof v4);
    return IsForbidden(ntohl(v4));
  }
  return IN6_IS_ADDR_LOOPBACK(&bytes) || IN6_IS_ADDR_UNSPECIFIED(&bytes) || IN6_IS_ADDR_LINKLOCAL(&bytes);
}

bool IsOfThisMachine(const std::string& host) {
  addrinfo* found = nullptr;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return true;
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> all(found, &::freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    if (IsForbidden(*one->ai_addr)) return true;
  }
  return false;
}

}  // namespace

std::string HostOfSource(const std::string& url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string::npos) return "";
  std::string host = url.substr(scheme + 3);
  host = host.substr(0, host.find_first_of("/?#"));
  host = host.substr(host.rfind('@') + 1);  // npos + 1 is 0
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.find(':'));
}

Status CheckSource(const std::string& url, std::span<const std::string> allowed) {
  const std::string host = LowerCase(HostOfSource(url));
  const bool is_listed = std::ranges::any_of(allowed, [&](const std::string& one) { return LowerCase(one) == host; });
  // What only receives connects to nothing. Others take an empty host for this machine.
  const bool receives = url.starts_with("udp://") || url.starts_with("rtp://") ||
                        (url.starts_with("srt://") && url.contains("mode=listener"));
  if (is_listed || (allowed.empty() && (receives || (!host.empty() && !IsOfThisMachine(host))))) return {};
  return Fail(ErrorCode::kPermissionDenied,
              "this server does not open this address: an administrator can allow it by `victorious serve "
              "--live-sources HOST`");
}

}  // namespace victorious
