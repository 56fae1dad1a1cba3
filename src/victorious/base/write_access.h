// Whether files can be written, asked before hours of work rather than after.
#pragma once

#include <filesystem>

namespace victorious {

/// Whether this process may write to a file, or create files in a folder. If not, errno says why (ErrorFromErrno).
[[nodiscard]] bool IsWritable(const std::filesystem::path& path);

}  // namespace victorious
