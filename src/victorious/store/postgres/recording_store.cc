#include "victorious/store/postgres/recording_store.h"

#include <utility>

#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {
namespace {

std::vector<Recording> ReadRecordings(Result rows) {
  std::vector<Recording> recordings;
  while (rows.Next()) {
    recordings.push_back(
        {.path = rows.Text(0), .source = rows.Text(1), .from_utc_us = rows.Integer(2), .to_utc_us = rows.Integer(3)});
  }
  return recordings;
}

}  // namespace

Expected<std::unique_ptr<RecordingStore>> RecordingStore::Open(const std::string& url) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::shared_ptr<Connection> connection, OpenIndex(url, StoreMode::kCreate));
  return std::make_unique<RecordingStore>(std::move(connection));
}

Status RecordingStore::Put(const Recording& recording) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result put,
      connection_->Write("INSERT INTO recordings (path, source, from_utc_us, to_utc_us) VALUES (?, ?, ?, ?) "
                         "ON CONFLICT (path) DO NOTHING",
                         recording.path, recording.source, recording.from_utc_us, recording.to_utc_us));
  return {};
}

Status RecordingStore::Remove(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Result removed, connection_->Write("DELETE FROM recordings WHERE path = ?", path));
  return {};
}

Status RecordingStore::Settle(const std::string& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Result settled,
                              connection_->Write("UPDATE recordings SET is_settled = true WHERE path = ?", path));
  return {};
}

Expected<std::vector<Recording>> RecordingStore::Of(const std::string& source) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows,
                              connection_->Query("SELECT path, source, from_utc_us, to_utc_us FROM recordings "
                                                 "WHERE source = ? ORDER BY from_utc_us",
                                                 source));
  return ReadRecordings(std::move(rows));
}

Expected<std::vector<Recording>> RecordingStore::Unsettled() {
  VICTORIOUS_ASSIGN_OR_RETURN(Result rows,
                              connection_->Query("SELECT path, source, from_utc_us, to_utc_us FROM recordings "
                                                 "WHERE NOT is_settled ORDER BY source, from_utc_us"));
  return ReadRecordings(std::move(rows));
}

}  // namespace victorious::postgres
