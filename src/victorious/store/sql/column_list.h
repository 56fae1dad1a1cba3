// The columns of a table as one list: from it come the texts of SELECT and INSERT, the positions of parameters and
// results, and a compile error for a name that is not in it.
//
//   inline constexpr ColumnList kBoxColumns({"x_px", "y_px"});
//   connection.Prepare(kBoxColumns.Insert("boxes"));          // INSERT INTO boxes (x_px, y_px) VALUES (?, ?)
//   insert.BindAt(kBoxColumns.Parameter("y_px"), box.y);      // parameter 2
//   row.Real(kBoxColumns.Index("y_px"));                      // column 1
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace victorious::sql {

/// "?, ?" for "x_px, y_px": one parameter for each column.
[[nodiscard]] inline std::string ParametersOf(std::string_view columns) {
  std::string parameters = "?";
  for (const char c : columns) {
    if (c == ',') parameters += ", ?";
  }
  return parameters;
}

/// "INSERT INTO boxes (x_px, y_px) VALUES (?, ?) "
[[nodiscard]] inline std::string InsertInto(std::string_view table, std::string_view columns) {
  return fmt::format("INSERT INTO {} ({}) VALUES ({}) ", table, columns, ParametersOf(columns));
}

template <std::size_t kCount>
class ColumnList {
 public:
  consteval explicit ColumnList(const std::string_view (&names)[kCount]) {
    for (std::size_t i = 0; i < kCount; ++i) names_[i] = names[i];
  }

  /// Position in the result of a SELECT that begins with Names(), from 0. A name that is not in the list does not
  /// compile.
  [[nodiscard]] consteval int Index(std::string_view name) const {
    for (std::size_t i = 0; i < kCount; ++i) {
      if (names_[i] == name) return static_cast<int>(i);
    }
    throw "the list has no column of this name";
  }
  /// Position of the parameter in Insert(), from 1.
  [[nodiscard]] consteval int Parameter(std::string_view name) const { return Index(name) + 1; }
  /// Position of the first column after those of the list, from 0.
  [[nodiscard]] static constexpr int Size() { return static_cast<int>(kCount); }

  /// "s.x_px, s.y_px" for the table alias "s"; "x_px, y_px" for none.
  [[nodiscard]] std::string Names(std::string_view alias = {}) const {
    return Join(0, [&](std::string_view name) {
      return alias.empty() ? std::string(name) : std::string(alias) + "." + std::string(name);
    });
  }
  /// "y_px = excluded.y_px": for ON CONFLICT DO UPDATE SET of the columns from position `first` on.
  [[nodiscard]] std::string Updates(int first) const {
    return Join(first, [](std::string_view name) { return std::string(name) + " = excluded." + std::string(name); });
  }
  /// "INSERT INTO boxes (x_px, y_px) VALUES (?, ?) "
  [[nodiscard]] std::string Insert(std::string_view table) const { return InsertInto(table, Names()); }

 private:
  template <typename Write>
  [[nodiscard]] std::string Join(int first, const Write& write) const {
    std::string text;
    for (std::size_t i = static_cast<std::size_t>(first); i < kCount; ++i) {
      if (!text.empty()) text += ", ";
      text += write(names_[i]);
    }
    return text;
  }

  std::array<std::string_view, kCount> names_;
};

}  // namespace victorious::sql
