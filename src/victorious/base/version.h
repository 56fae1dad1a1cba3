// The program's version, stored in every file that it writes.
#pragma once

namespace victorious {

inline constexpr const char* kVersion = VICTORIOUS_VERSION;

}  // namespace victorious
