// What a file is, by how it begins: before it is replaced, and where formats share an extension.
#pragma once

#include <initializer_list>
#include <string_view>

namespace victorious {

/// Up to its first line break, which is not part of it.
[[nodiscard]] std::string_view FirstLine(std::string_view head);

/// Whether the first line is a JSON object with all of these members.
[[nodiscard]] bool IsJsonLine(std::string_view head, std::initializer_list<const char*> members);

/// Whether the text begins as a JSON object does, and has all of these texts.
[[nodiscard]] bool IsJsonWith(std::string_view head, std::initializer_list<std::string_view> texts);

/// Whether a text of at least one character has no other characters than these.
[[nodiscard]] bool IsTextOf(std::string_view text, std::string_view allowed);

}  // namespace victorious
