// "Did you mean": the known name that a mistyped word is nearest to.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace victorious::cli {

/// The number of insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal string
/// alignment distance).
[[nodiscard]] std::size_t EditDistance(std::string_view a, std::string_view b);

/// The first of `known` with the smallest edit distance to `word`; std::nullopt if that is more than a third of the
/// word's length, rounded up: words that have little in common are no typing errors.
[[nodiscard]] std::optional<std::string> FindNearest(std::string_view word, std::span<const std::string> known);

}  // namespace victorious::cli
