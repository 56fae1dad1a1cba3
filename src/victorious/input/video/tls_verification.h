// Private to video/: makes FFmpeg verify the certificates of servers (trusted_certificates.h).
#pragma once

#include <cstdarg>
#include <string>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

/// Makes all that FFmpeg opens by TLS from now on verify the server's certificate and its host name. Called by
/// PrepareFfmpeg(). False: it cannot be made to.
bool VerifyCertificates();

/// Error: kUnsupported for an address that is encrypted, if certificates cannot be verified.
[[nodiscard]] Status CheckVerifies(std::string_view scheme, const std::string& url);

/// Keeps what FFmpeg's TLS says of a failure on this thread; other lines are dropped. FFmpeg's log callback.
void KeepTlsFault(void* object, int level, const char* format, std::va_list arguments);

/// What is wrong with the last connection of this thread, and what would be right; empty: nothing was said. Forgets it.
[[nodiscard]] std::string TakeTlsFault();

}  // namespace victorious
