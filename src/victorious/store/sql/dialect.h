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

/// An aggregate: the integers of the rows as a text, "3,1,3".
[[nodiscard]] std::string ListOf(Dialect dialect, std::string_view integer);

/// The greater, or the lesser, of two numbers.
[[nodiscard]] std::string Greater(Dialect dialect, std::string_view a, std::string_view b);
[[nodiscard]] std::string Lesser(Dialect dialect, std::string_view a, std::string_view b);

/// The words between two tables of a query that are best read in the order given: SQLite has no statistics, and may
/// choose another one. PostgreSQL has them.
[[nodiscard]] std::string_view JoinInOrder(Dialect dialect);

/// " INDEXED BY …" after a table's name: SQLite has no statistics, and may choose another index. PostgreSQL has them,
/// and takes no such words: empty.
[[nodiscard]] std::string IndexedBy(Dialect dialect, std::string_view index);

}  // namespace victorious::sql
