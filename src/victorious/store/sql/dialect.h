// What SQLite and PostgreSQL write in different words.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace victorious::sql {

enum class Dialect { kSqlite, kPostgres };

/// The condition that a column is one of a list of ids. Its parameter is the list, by ListText.
[[nodiscard]] std::string IsOneOf(Dialect dialect, std::string_view column);
[[nodiscard]] std::string ListText(Dialect dialect, std::span<const std::int64_t> ids);

/// A text with its ASCII letters in lower case.
[[nodiscard]] std::string Lower(Dialect dialect, std::string_view text);
/// The condition that a text contains another one.
[[nodiscard]] std::string Contains(Dialect dialect, std::string_view text, std::string_view part);

/// " INDEXED BY …" after a table's name: SQLite has no statistics, and may choose another index. PostgreSQL has them,
/// and takes no such words: empty.
[[nodiscard]] std::string IndexedBy(Dialect dialect, std::string_view index);

}  // namespace victorious::sql
