// Schema versions and migrations of an index in PostgreSQL. The schema `victorious` of a database is the index; its
// table `version` has the version.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/postgres/connection.h"

namespace victorious::postgres {

/// The SQL that migrates a database from version - 1 to `version`.
struct Migration {
  int version = 0;
  std::string_view sql;
};

/// Returns all migrations in order: versions 1, 2, ….
std::span<const Migration> Migrations();

/// Returns the schema version; 0 for a database without an index. Errors: kUnsupported (a schema of another program, or
/// newer than `newest`), kDataLoss (damaged).
[[nodiscard]] Expected<int> ReadVersion(Connection& connection, int newest);

/// Checks that the database has an index of this program's version. Errors: those of ReadVersion; kNotFound (no index),
/// kUnsupported (an older version).
[[nodiscard]] Status CheckVersion(Connection& connection);

/// Migrates the database to the last of `migrations`, each in its own transaction. Safe if two processes do so at once.
/// Errors: kUnsupported if the server has no PostGIS; kPermissionDenied if the role may not add it, or make a schema.
[[nodiscard]] Status Migrate(Connection& connection, std::span<const Migration> migrations);

/// Opens the connection to an index; kCreate makes its tables if there are none. Errors: those of Connection::Open,
/// CheckVersion and Migrate.
/// @param task  see Connection::Open
[[nodiscard]] Expected<std::unique_ptr<Connection>> OpenIndex(const std::string& url, StoreMode mode,
                                                              std::optional<TaskAttempt> task = {});

}  // namespace victorious::postgres
