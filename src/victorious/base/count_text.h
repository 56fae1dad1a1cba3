// Counts in messages: "1 frame", "2 frames".
#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace victorious {

/// @param what  the name of one, whose plural ends in s
[[nodiscard]] std::string CountText(std::integral auto count, std::string_view what) {
  return std::to_string(count) + " " + std::string(what) + (count == 1 ? "" : "s");
}

}  // namespace victorious
