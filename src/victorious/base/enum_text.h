// Texts of enums: one table per enum serves field lists (options.h), JSON, files, the command line and messages.
//
//   enum class Filter { kCascade, kNone };
//   inline constexpr auto kFilterTexts =
//       std::to_array<EnumText<Filter>>({{Filter::kCascade, "cascade"}, {Filter::kNone, "none"}});
//
// Texts are stored in files: a published text never changes its value.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace victorious {

/// One value of an enum and its text.
template <typename Enum>
struct EnumText {
  Enum value;
  std::string_view text;
};

/// Returns the text of `value`; empty for a value that the table does not have.
template <typename Enum, std::size_t count>
constexpr std::string_view ToText(const std::array<EnumText<Enum>, count>& table, Enum value) {
  for (const EnumText<Enum>& entry : table) {
    if (entry.value == value) return entry.text;
  }
  return {};
}

/// Returns the value of `text`; std::nullopt for a text that the table does not have.
template <typename Enum, std::size_t count>
constexpr std::optional<Enum> FromText(const std::array<EnumText<Enum>, count>& table, std::string_view text) {
  for (const EnumText<Enum>& entry : table) {
    if (entry.text == text) return entry.value;
  }
  return std::nullopt;
}

/// Returns all texts, in the order of the table.
template <typename Enum, std::size_t count>
constexpr std::array<std::string_view, count> Texts(const std::array<EnumText<Enum>, count>& table) {
  std::array<std::string_view, count> texts;
  for (std::size_t i = 0; i < count; ++i) texts[i] = table[i].text;
  return texts;
}

}  // namespace victorious
