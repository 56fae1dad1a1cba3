#include "victorious/store/sql/database.h"

#include <type_traits>

namespace victorious::sql {

void ValueList::BindTo(Parameters& parameters) const {
  int parameter = 0;
  for (const Value& value : values_) {
    ++parameter;
    std::visit(
        [&](const auto& held) {
          if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::vector<std::byte>>) {
            parameters.BindAt(parameter, std::span<const std::byte>(held));
          } else {
            parameters.BindAt(parameter, held);
          }
        },
        value);
  }
}

ValueList::Value& ValueList::At(int parameter) {
  const auto position = static_cast<std::size_t>(parameter) - 1;
  if (position >= values_.size()) values_.resize(position + 1, std::nullopt);
  return values_[position];
}

Expected<std::int64_t> Database::ReadInteger(const std::string& sql, const ValueList& values) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto number, ReadOne(sql, values, [](const Row& row) -> Expected<std::int64_t> { return row.Integer(0); }));
  return number.value_or(0);
}

Expected<Change> Change::Begin(Database& database, Exclusion exclusion) {
  if (database.IsInTransaction()) return Change(nullptr);
  VICTORIOUS_RETURN_IF_ERROR(database.Begin(exclusion));
  return Change(&database);
}

Expected<Change> Change::BeginReading(Database& database) {
  if (database.IsInTransaction()) return Change(nullptr);
  VICTORIOUS_RETURN_IF_ERROR(database.BeginReading());
  return Change(&database);
}

Status Change::Commit() {
  if (database_ == nullptr) return {};
  return std::exchange(database_, nullptr)->Commit();
}

}  // namespace victorious::sql
