// The entries of a folder, with errors as values: iterators of the standard library throw where a folder on a network
// goes away, or is closed to its reader, in the middle.
#pragma once

#include <filesystem>
#include <vector>

#include "victorious/base/error.h"

namespace victorious {

/// Returns the paths of what is in `folder`, not below, sorted by name; each begins with `folder` as it is given. One
/// that goes away meanwhile may be among them. Errors: those of the file system, with the folder's name; kNotFound if
/// there is no such folder.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> ListFolder(const std::filesystem::path& folder);

}  // namespace victorious
