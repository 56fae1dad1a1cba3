// Gives back the memory of parts of mapped files (base/file.h) that have been read once and are rarely needed again.
#pragma once

#include <cstddef>
#include <span>

namespace victorious {

/// Gives back the pages of `bytes`, and those around them that the system mapped with them. They are read again when
/// next needed. No effect on bytes outside of every MappedFile. Thread-safe.
void ReleaseMappedPages(std::span<const std::byte> bytes);

}  // namespace victorious
