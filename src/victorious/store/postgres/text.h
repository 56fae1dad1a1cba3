// Texts in PostgreSQL: UTF-8 without NUL, while the program's texts (names of files) can be any bytes.
#pragma once

#include <string>
#include <string_view>

namespace victorious::postgres {

/// Returns valid UTF-8 without NUL that stands for `bytes`: the same text, in which each byte that PostgreSQL refuses
/// is the character U+10FF00 + byte. Different texts stay different. Characters from U+10FF00 to U+10FFFF, which no
/// standard assigns, are written as four such bytes.
[[nodiscard]] std::string EncodeText(std::string_view bytes);

/// The inverse of EncodeText.
[[nodiscard]] std::string DecodeText(std::string_view text);

}  // namespace victorious::postgres
