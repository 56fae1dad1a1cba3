// What everybody may read of a text that may have passwords in it: the one rule for logs, errors, events, and the names
// of live sources in every output.
#pragma once

#include <string>

namespace victorious {

/// A text without the names, the passwords and the queries of the addresses in it: "rtsp://ann:secret@host/one" to
/// "rtsp://host/one". Addresses of databases keep them: store/ reports those without their password.
[[nodiscard]] std::string WithoutCredentials(std::string text);

}  // namespace victorious
