// Identifies the program build in files that it writes: builds of the same version may give different results.
#pragma once

#include <filesystem>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

/// Returns the version and the checksum of the running executable, or of the shared library (own_file.h):
/// "0.1.0-0123456789abcdef". Ignores the libraries that it is linked with. Cost: reads it once, about 10 ms.
[[nodiscard]] Expected<std::string> ProgramId();

/// The same for another executable of this version.
[[nodiscard]] Expected<std::string> ComputeProgramId(const std::filesystem::path& executable);

}  // namespace victorious
