// IndexStore in a PostgreSQL database with PostGIS: what SqlIndexStore does not do by statements that SQLite shares.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/store/postgres/connection.h"
#include "victorious/store/postgres/postgres_database.h"
#include "victorious/store/sql/sql_index_store.h"

namespace victorious::postgres {

/// The advisory lock of UpdateObjects: "OBJS" in ASCII.
inline constexpr std::int64_t kObjectsLockKey = 0x4F424A53;

/// How long UpdateObjects waits for another process that updates objects.
struct ObjectsPatience {
  /// The server ends a session that stands still with the lock for this long.
  std::chrono::milliseconds others = std::chrono::minutes(30);
  std::chrono::milliseconds cancelled = std::chrono::seconds(10);  ///< in all, once cancelled
};

/// Visits return false or end before the store writes: VisitSightings and VisitKeptFrames hold a transaction that
/// reads.
class PostgresStore final : public sql::SqlIndexStore {
 public:
  /// @param connection  of a database with an index of this version
  explicit PostgresStore(const std::shared_ptr<Connection>& connection, ObjectsPatience patience = {})
      : SqlIndexStore(MakeSqlDatabase(connection)), connection_(connection), patience_(patience) {}

  [[nodiscard]] Status UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make,
                                     const CancelToken& cancel) override;
  /// The faults are those of kDataLoss, and rows without those that they refer to. Errors: others of reading.
  [[nodiscard]] Expected<std::vector<std::string>> FindFaults() override;

 private:
  /// The ids of a video's tracklets lie below those of the next video, whichever is indexed first.
  [[nodiscard]] Status ReserveTrackletIds(std::map<std::int64_t, std::int64_t>& by_video) override;
  [[nodiscard]] Status AssignAllReviews() override;
  [[nodiscard]] Status AssignReviewsOf(std::span<const std::int64_t> tracklets) override;
  [[nodiscard]] Status SummariseDecisions(std::int64_t object) override;
  /// The number of the server's process for this connection.
  [[nodiscard]] Expected<std::int64_t> Session();
  /// Waits for the lock of UpdateObjects. Returns the session that holds it. Errors: kCancelled, kUnavailable: another
  /// process has held it for too long.
  [[nodiscard]] Expected<std::int64_t> LockObjects(const CancelToken& cancel);
  /// Says who holds the lock of UpdateObjects, as far as the server tells this role.
  [[nodiscard]] Expected<std::string> DescribeHolder();
  [[nodiscard]] Status UnlockObjects();

  std::shared_ptr<Connection> connection_;
  ObjectsPatience patience_;
};

}  // namespace victorious::postgres

namespace victorious {

/// Opens an index in a PostgreSQL database; kCreate makes its tables if there are none. Errors: those of
/// Connection::Open; kNotFound (no index in the database, to read); kUnsupported (a schema of another program, or of
/// another version; no PostGIS on the server).
/// @param url, task  see Connection::Open
[[nodiscard]] Expected<std::unique_ptr<IndexStore>> OpenPostgresStore(const std::string& url, StoreMode mode,
                                                                      std::optional<TaskAttempt> task = {});

}  // namespace victorious
