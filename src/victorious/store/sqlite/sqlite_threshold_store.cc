// ThresholdStore in the SQLite file of an index.
#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/store/export_json.h"
#include "victorious/store/sqlite/open_database.h"
#include "victorious/store/threshold_store.h"

namespace victorious::sqlite {
namespace {

class SqliteThresholdStore final : public ThresholdStore {
 public:
  explicit SqliteThresholdStore(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

  Expected<std::vector<ModelThreshold>> Thresholds() override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT model_name, min_score, set_by, set_utc_us FROM thresholds ORDER BY model_name"));
    std::vector<ModelThreshold> thresholds;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return thresholds;
      thresholds.push_back({.model = select.Text(0),
                            .min_score = select.Real(1),
                            .set_by = select.Text(2),
                            .set_utc_us = select.Integer(3)});
    }
  }

  Status Put(const ModelThreshold& threshold) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    {
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement put,
          connection_->Prepare("INSERT INTO thresholds (model_name, min_score, set_by, set_utc_us) VALUES (?, ?, ?, ?) "
                               "ON CONFLICT DO UPDATE SET min_score = excluded.min_score, set_by = excluded.set_by, "
                               "set_utc_us = excluded.set_utc_us"));
      put.Bind(threshold.model, threshold.min_score, threshold.set_by, threshold.set_utc_us);
      VICTORIOUS_RETURN_IF_ERROR(put.Run());
    }
    VICTORIOUS_RETURN_IF_ERROR(
        Log(threshold.model, threshold.set_by, threshold.set_utc_us, ScoreJson(threshold.min_score)));
    return transaction.Commit();
  }

  Status Remove(const std::string& model, const std::string& actor, std::int64_t now_us) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement remove,
                                  connection_->Prepare("DELETE FROM thresholds WHERE model_name = ?"));
      VICTORIOUS_RETURN_IF_ERROR(remove.Bind(model).Run());
    }
    if (connection_->Changes() == 0) return {};
    VICTORIOUS_RETURN_IF_ERROR(Log(model, actor, now_us, nullptr));
    return transaction.Commit();
  }

  Expected<std::vector<ModelDecisions>> Decisions() override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare("SELECT model_id, order_score, verdict FROM objects INDEXED BY "
                                                     "objects_by_rank WHERE is_listed = 1 AND verdict IS NOT NULL"));
    std::map<std::int64_t, std::vector<DecidedScore>> by_model;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) break;
      by_model[select.Integer(0)].push_back({-select.Real(1), select.Text(2) == ToText(Verdict::kAccepted)});
    }
    std::vector<ModelDecisions> all;
    for (auto& [model, decisions] : by_model) all.push_back({model, std::move(decisions)});
    return all;
  }

 private:
  Status Log(const std::string& model, const std::string& actor, std::int64_t now_us, const Json& min_score) {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement insert,
                                connection_->Prepare("INSERT INTO audit (time_utc_us, actor, action, subject, detail) "
                                                     "VALUES (?, ?, 'threshold', ?, ?)"));
    insert.Bind(now_us, actor, "model " + model, DumpJson(Json({{"min_score", min_score}})));
    return insert.Run();
  }

  std::unique_ptr<Connection> connection_;
};

}  // namespace
}  // namespace victorious::sqlite

namespace victorious {

Expected<std::unique_ptr<ThresholdStore>> OpenSqliteThresholdStore(const std::filesystem::path& path, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, mode));
  return std::make_unique<sqlite::SqliteThresholdStore>(std::move(connection));
}

}  // namespace victorious
