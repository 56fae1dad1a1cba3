// Which program this is, for what it makes and keeps: a version is worked on for long, and gives other results by and
// by.
#pragma once

#include <filesystem>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

/// The version, and the checksum of the executable that runs: "0.1.0-0123456789abcdef". Libraries that are linked
/// dynamically are not looked at.
/// Cost: the executable is read once, some 10 ms.
Expected<std::string> ProgramId();

/// The same of another executable of this version.
Expected<std::string> ProgramIdOf(const std::filesystem::path& executable);

}  // namespace victorious
