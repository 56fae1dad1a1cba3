// Writing in parts what is too large for memory: to a file, atomically as WriteFileAtomically (file.h) does, or to a
// descriptor such as standard output.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string_view>

#include "victorious/base/error.h"

namespace victorious {

/// Writes a content to a stream. The stream is not good() any more once the file or descriptor takes no more bytes.
using WriteContent = std::function<Status(std::ostream&)>;

/// As WriteFileAtomically, of the bytes that `write` gives, with a buffer of kWriterBufferBytes. If `write` fails, the
/// file stays as it was. Errors: those of WriteFileAtomically, which come first, and those of `write`.
[[nodiscard]] Status WriteFileInParts(const std::filesystem::path& path, const WriteContent& write);

/// Writes to an open descriptor, which stays open. A content of at most kWriterBufferBytes is written only if `write`
/// succeeds; of a larger one, the part before the error may be out.
/// @param name  for messages, "standard output"
[[nodiscard]] Status WriteInParts(int descriptor, std::string_view name, const WriteContent& write);

inline constexpr std::size_t kWriterBufferBytes = std::size_t{1} << 20;

}  // namespace victorious
