// The file that holds the code of this program: the program, or the shared library if another program has loaded that.
// What is installed beside it, and what identifies its build, is found by it.
#pragma once

#include <filesystem>

namespace victorious {

/// The path of the running program or of the shared library; empty if the system does not say.
[[nodiscard]] std::filesystem::path OwnFile();

/// False: the code is a shared library that another program has loaded.
[[nodiscard]] bool IsOwnProgram();

}  // namespace victorious
