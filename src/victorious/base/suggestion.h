// "Did you mean": the known name that a mistyped word is nearest to.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace victorious {

/// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal string
/// alignment distance).
[[nodiscard]] std::size_t EditDistance(std::string_view a, std::string_view b);

/// The most edits of a typing error: a third of the word's length, rounded up. Words that differ more have little in
/// common.
[[nodiscard]] std::size_t MaxTypingEdits(std::string_view word);

/// The first of `known` with the smallest edit distance to `word`; std::nullopt if that is more than MaxTypingEdits().
[[nodiscard]] std::optional<std::string> FindNearest(std::string_view word, std::span<const std::string> known);

}  // namespace victorious
