#include "victorious/store/sql/dialect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace victorious::sql {

std::string IsOneOf(Dialect dialect, std::string_view column) {
  return fmt::format(
      fmt::runtime(dialect == Dialect::kSqlite ? "{} IN (SELECT value FROM json_each(?))" : "{} = ANY (?::bigint[])"),
      column);
}

std::string ListText(Dialect dialect, std::span<const std::int64_t> ids) {
  const bool is_json = dialect == Dialect::kSqlite;
  return fmt::format("{}{}{}", is_json ? '[' : '{', fmt::join(ids, ","), is_json ? ']' : '}');
}

// PostgreSQL's lower() follows the locale of the database, unless the text has the collation C.
std::string Lower(Dialect dialect, std::string_view text) {
  return fmt::format("lower({}{})", text, dialect == Dialect::kSqlite ? "" : " COLLATE \"C\"");
}

std::string Contains(Dialect dialect, std::string_view text, std::string_view part) {
  return fmt::format("{}({}, {}) > 0", dialect == Dialect::kSqlite ? "instr" : "strpos", text, part);
}

std::string ListOf(Dialect dialect, std::string_view integer) {
  return fmt::format(fmt::runtime(dialect == Dialect::kSqlite ? "group_concat({})" : "string_agg({}::text, ',')"),
                     integer);
}

std::string Greater(Dialect dialect, std::string_view a, std::string_view b) {
  return fmt::format("{}({}, {})", dialect == Dialect::kSqlite ? "max" : "greatest", a, b);
}

std::string Lesser(Dialect dialect, std::string_view a, std::string_view b) {
  return fmt::format("{}({}, {})", dialect == Dialect::kSqlite ? "min" : "least", a, b);
}

std::string_view JoinInOrder(Dialect dialect) { return dialect == Dialect::kSqlite ? "CROSS JOIN" : "JOIN"; }

std::string IndexedBy(Dialect dialect, std::string_view index) {
  return dialect == Dialect::kSqlite ? fmt::format(" INDEXED BY {}", index) : "";
}

}  // namespace victorious::sql
