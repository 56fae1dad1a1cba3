#include "victorious/store/sqlite/statement.h"

#include <sqlite3.h>

#include "victorious/store/sqlite/connection.h"

namespace victorious::sqlite {

Statement::~Statement() {
  if (handle_ != nullptr) connection_->ReturnToCache(sql_, handle_);
}

void Statement::RecordBindError(int code) {
  if (bind_code_ == SQLITE_OK) bind_code_ = code;
}

void Statement::BindAt(int parameter, std::int64_t value) {
  RecordBindError(sqlite3_bind_int64(handle_, parameter, value));
}

void Statement::BindAt(int parameter, double value) { RecordBindError(sqlite3_bind_double(handle_, parameter, value)); }

// SQLite binds NULL for a null pointer, even at length 0: an empty value needs a non-null pointer.
void Statement::BindAt(int parameter, std::string_view value) {
  RecordBindError(sqlite3_bind_text64(handle_, parameter, value.empty() ? "" : value.data(), value.size(),
                                      SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::BindAt(int parameter, std::span<const std::byte> value) {
  const void* data = value.empty() ? static_cast<const void*>("") : value.data();
  RecordBindError(sqlite3_bind_blob64(handle_, parameter, data, value.size(), SQLITE_TRANSIENT));
}

void Statement::BindAt(int parameter, std::nullopt_t) { RecordBindError(sqlite3_bind_null(handle_, parameter)); }

Expected<bool> Statement::Step() {
  const int code = bind_code_ == SQLITE_OK ? sqlite3_step(handle_) : bind_code_;
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  return std::unexpected(connection_->ErrorFromCode(code));
}

Status Statement::Run() {
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, Step());
    if (!has_row) break;
  }
  sqlite3_reset(handle_);
  return {};
}

bool Statement::IsNull(int column) const { return sqlite3_column_type(handle_, column) == SQLITE_NULL; }

std::int64_t Statement::Integer(int column) const { return sqlite3_column_int64(handle_, column); }

double Statement::Real(int column) const { return sqlite3_column_double(handle_, column); }

std::string Statement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column)));
}

std::span<const std::byte> Statement::Blob(int column) const {
  const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(handle_, column));
  if (data == nullptr) return {};
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

}  // namespace victorious::sqlite
