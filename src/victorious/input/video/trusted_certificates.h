// Which servers are trusted whose addresses are encrypted by TLS (rtsps, https, rtmps): those whose certificate names
// the host of the address and was issued by an authority that this process trusts. No name and no password are sent
// before. By default these are the authorities of the system.
//
// FFmpeg verifies no certificate unless its protocol "tls" is set to, and its RTSP and HLS readers pass no options on
// to it (FFmpeg 5.1). Therefore the defaults of that protocol's options are changed, for the whole process.
#pragma once

#include <filesystem>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

/// Trusts the certificates of a file (PEM) instead of those of the system. Called before an address is opened, by one
/// thread. Error: kInvalidArgument unless the file has a certificate.
[[nodiscard]] Status TrustCertificates(const std::filesystem::path& file);

/// The file given to TrustCertificates; empty: those of the system are trusted. For processes that this one starts.
[[nodiscard]] const std::filesystem::path& TrustedCertificates();

}  // namespace victorious
