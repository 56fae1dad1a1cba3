// External text in a message of one line.
#pragma once

#include <algorithm>
#include <string>

namespace victorious {

/// Returns the text with its control characters (line ends, those of a file name) replaced by '?'.
[[nodiscard]] inline std::string OneLine(std::string text) {
  constexpr char kDelete = 0x7f;
  std::ranges::replace_if(text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == kDelete; }, '?');
  return text;
}

}  // namespace victorious
