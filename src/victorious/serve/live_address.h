// Addresses of live sources, as everybody may see them.
#pragma once

#include <string>

namespace victorious {

/// A text without the name and the password of the addresses in it: "rtsp://ann:secret@host/one" to "rtsp://host/one".
[[nodiscard]] std::string WithoutCredentials(std::string text);

}  // namespace victorious
