// IndexStore in one SQLite file: what SqlIndexStore does not do by statements that PostgreSQL shares.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "victorious/store/sql/sql_index_store.h"
#include "victorious/store/sqlite/connection.h"
#include "victorious/store/sqlite/sqlite_database.h"

namespace victorious::sqlite {

class SqliteStore final : public sql::SqlIndexStore {
 public:
  explicit SqliteStore(const std::shared_ptr<Connection>& connection)
      : SqlIndexStore(MakeSqlDatabase(connection)), connection_(connection) {}

  [[nodiscard]] Status UpdateObjects(const std::function<Expected<ObjectUpdate>()>& make,
                                     const CancelToken& cancel) override;
  /// All errors of reading are faults.
  [[nodiscard]] Expected<std::vector<std::string>> FindFaults() override;

 private:
  [[nodiscard]] Status ReserveTrackletIds(std::map<std::int64_t, std::int64_t>& by_video) override;
  [[nodiscard]] Status AssignAllReviews() override;
  [[nodiscard]] Status AssignReviewsOf(std::span<const std::int64_t> tracklets) override;
  [[nodiscard]] Status SummariseDecisions(std::int64_t object) override;

  std::shared_ptr<Connection> connection_;
};

}  // namespace victorious::sqlite
