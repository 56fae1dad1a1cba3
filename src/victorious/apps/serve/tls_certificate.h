// The certificate with which a server proves its name, for TLS 1.2 and 1.3 (OpenSSL).
#pragma once

#include <filesystem>

#include "victorious/base/error.h"

namespace boost::asio::ssl {
class context;
}

namespace victorious {

/// Prepares the context of a server.
/// @param certificate  PEM: the server's, then those that issued it
/// @param key          PEM, not encrypted
/// Errors: kNotFound, kPermissionDenied; kInvalidArgument for a file that is not of this kind, and for a certificate
/// and key that do not belong together.
[[nodiscard]] Status LoadCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key,
                                     boost::asio::ssl::context& context);

}  // namespace victorious
