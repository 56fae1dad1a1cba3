// Which addresses of live sources the server opens for its users, so that nobody looks through it for what answers in
// the server's own network: not this machine, nor link-local addresses (169.254.169.254 of clouds), unless they are
// listed. A name is resolved here and again by who opens the source: no protection from names whose addresses change,
// nor from sources that lead elsewhere.
#pragma once

#include <span>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

/// The host of an address as FFmpeg reads it, without user and port; empty: none, as of what listens.
[[nodiscard]] std::string HostOfSource(const std::string& url);

/// @param allowed  hosts, names or addresses; empty: all but those of this machine and link-local ones
/// Error: kPermissionDenied, also for a name that is not known: the messages are alike.
[[nodiscard]] Status CheckSource(const std::string& url, std::span<const std::string> allowed);

}  // namespace victorious
