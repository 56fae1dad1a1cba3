#include "victorious/apps/serve/tls_certificate.h"

#include <cerrno>
#include <string>

#include <boost/asio/ssl/context.hpp>
#include <fmt/format.h>
#include <unistd.h>

namespace victorious {

namespace ssl = boost::asio::ssl;

Status LoadCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key,
                       ssl::context& context) {
  for (const std::filesystem::path& file : {certificate, key}) {
    if (::access(file.c_str(), R_OK) != 0) return std::unexpected(ErrorFromErrno(errno, file.string()));
  }
  context.set_options(ssl::context::no_tlsv1 | ssl::context::no_tlsv1_1 | SSL_OP_NO_RENEGOTIATION);
  // Of TLS 1.2 only suites with forward secrecy and without CBC; those of TLS 1.3 all are so.
  if (SSL_CTX_set_cipher_list(context.native_handle(), "ECDHE+AESGCM:ECDHE+CHACHA20") != 1)
    return Fail(ErrorCode::kInternal, "OpenSSL has no cipher suite with forward secrecy");
  // Else OpenSSL asks for it on the terminal.
  context.set_password_callback([](std::size_t, ssl::context::password_purpose) { return std::string(); });
  boost::system::error_code error;
  context.use_certificate_chain_file(certificate.string(), error);
  if (error) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: not a certificate in PEM form ({})", certificate.string(), error.message()));
  }
  context.use_private_key_file(key.string(), ssl::context::pem, error);
  if (error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: not the unencrypted private key of {} in PEM form ({})",
                                                         key.string(), certificate.string(), error.message()));
  }
  return {};
}

}  // namespace victorious
