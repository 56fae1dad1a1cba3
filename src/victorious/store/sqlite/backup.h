// A copy of an index while others read and write it.
#pragma once

#include <filesystem>

#include "victorious/base/error.h"

namespace victorious::sqlite {

/// Copies the index at one moment, by SQLite's backup interface: each transaction is in the copy or is not, as a whole.
/// Nobody who reads or writes the index waits for it. The copy can be read by its user only, is checked for damage, and
/// has its name once it is complete.
/// @param target  must not exist
/// Errors: those of OpenDatabase(kRead); kAlreadyExists; kNoSpace, kPermissionDenied; kDataLoss if the copy is damaged,
/// because the index is.
[[nodiscard]] Status BackUp(const std::filesystem::path& index, const std::filesystem::path& target);

}  // namespace victorious::sqlite
