// Reads a file, or what an address of the web gives, as bytes, from the first to the last. For files that are fetched
// from another machine, whatever they hold; VideoReader opens addresses of videos by itself.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

struct AddressOptions {
  double timeout_s = 30;             ///< limit of each wait for the next bytes
  std::function<bool()> is_stopped;  ///< called often, also while waiting
};

/// Whether this is an address that ReadAddress reads over HTTP: "http://…" or "https://…".
[[nodiscard]] bool IsWebAddress(const std::string& address);

/// Passes the bytes to `sink` as they come. The certificate of an https server must be trusted
/// (trusted_certificates.h); proxies are those of the environment (http_proxy).
/// @param address  IsWebAddress, or the path of a file
/// @param sink     an error of it ends the reading
/// Errors: kNotFound, also what the server says of an address that it does not give; kUnavailable if the server cannot
/// be reached, or sends nothing for so long; kDataLoss if it ends before the length that it announced; kCancelled; that
/// of `sink`.
[[nodiscard]] Status ReadAddress(const std::string& address, const AddressOptions& options,
                                 const std::function<Status(std::span<const std::byte>)>& sink);

}  // namespace victorious
