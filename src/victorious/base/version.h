// The program's version, stored with everything it writes.
#pragma once

namespace victorious {

inline constexpr const char* kVersion = VICTORIOUS_VERSION;

}  // namespace victorious
