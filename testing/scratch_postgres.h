// A PostgreSQL server for the tests of this process (tools/scratch_postgres.sh), and the stores that the contract of
// IndexStore is tested on.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/types.h>

#include "victorious/base/error.h"

namespace victorious::testing {

/// A server that runs as long as this object, or as this process, lives.
class ScratchPostgres {
 public:
  /// @param settings  of the server, NAME=VALUE, before those of the script: it does not sync unless fsync=on is given
  explicit ScratchPostgres(const std::vector<std::string>& settings = {});
  ~ScratchPostgres() { Stop(); }
  ScratchPostgres(const ScratchPostgres&) = delete;
  ScratchPostgres& operator=(const ScratchPostgres&) = delete;

  /// Of an empty database; its role is a superuser. Error: kUnsupported if PostgreSQL or PostGIS is not installed.
  [[nodiscard]] const Expected<std::string>& url() const { return url_; }

 private:
  [[nodiscard]] Expected<std::string> ReadUrl(int output);
  /// Ends the server. Returns the status of the script.
  int Stop();

  Expected<std::string> url_;
  pid_t process_ = -1;
  int input_ = -1;
};

/// Returns the URL of an empty database: starts the server at the first call, and removes the index of the former test.
/// The role is a superuser. Error: kUnsupported if PostgreSQL or PostGIS is not installed.
[[nodiscard]] Expected<std::string> EmptyPostgresDatabase();

/// A kind of store.
struct StoreKind {
  std::string name;
  /// Returns what OpenStore takes, of a new index; `folder` is empty. Error: kUnsupported as above.
  std::function<Expected<std::string>(const std::filesystem::path& folder)> make;
};

inline void PrintTo(const StoreKind& kind, std::ostream* out) { *out << kind.name; }

inline StoreKind SqliteKind() {
  return {"Sqlite", [](const std::filesystem::path& folder) { return (folder / "index.db").string(); }};
}

inline StoreKind PostgresKind() {
  return {"Postgres", [](const std::filesystem::path&) { return EmptyPostgresDatabase(); }};
}

}  // namespace victorious::testing

/// Assigns the name of a new index to `variable`, or skips the test by name where the kind of store is not installed.
#define VICTORIOUS_STORE_OR_SKIP(variable, made)                                                     \
  do {                                                                                               \
    auto victorious_store = (made);                                                                  \
    if (!victorious_store && victorious_store.error().code == ::victorious::ErrorCode::kUnsupported) \
      GTEST_SKIP() << "SKIPPED: " << victorious_store.error().message;                               \
    ASSERT_TRUE(victorious_store) << victorious_store.error().message;                               \
    variable = *std::move(victorious_store);                                                         \
  } while (false)

/// Runs a parameterised suite on every kind of store; the names begin with that of the kind.
#define VICTORIOUS_TEST_ON_ALL_STORES(Suite)                                                          \
  INSTANTIATE_TEST_SUITE_P(Sqlite, Suite, ::testing::Values(::victorious::testing::SqliteKind()),     \
                           [](const auto& kind) { return kind.param.name; });                         \
  INSTANTIATE_TEST_SUITE_P(Postgres, Suite, ::testing::Values(::victorious::testing::PostgresKind()), \
                           [](const auto& kind) { return kind.param.name; })
