// ThresholdStore in an index.
#include "victorious/store/sql/sql_threshold_store.h"

#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/database.h"
#include "victorious/types/json_values.h"

namespace victorious::sql {
namespace {

class SqlThresholdStore final : public ThresholdStore {
 public:
  explicit SqlThresholdStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}

  Expected<std::vector<ModelThreshold>> Thresholds() override {
    return database_->ReadAll(
        "SELECT model_name, min_score, set_by, set_utc_us FROM thresholds ORDER BY model_name", ValueList(),
        [](const Row& row) -> Expected<ModelThreshold> {
          return ModelThreshold{
              .model = row.Text(0), .min_score = row.Real(1), .set_by = row.Text(2), .set_utc_us = row.Integer(3)};
        });
  }

  Status Put(const ModelThreshold& threshold) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_RETURN_IF_ERROR(database_->Write(
        "INSERT INTO thresholds (model_name, min_score, set_by, set_utc_us) VALUES (?, ?, ?, ?) "
        "ON CONFLICT (model_name) DO UPDATE SET min_score = excluded.min_score, set_by = excluded.set_by, "
        "set_utc_us = excluded.set_utc_us",
        ValueList(threshold.model, threshold.min_score, threshold.set_by, threshold.set_utc_us)));
    VICTORIOUS_RETURN_IF_ERROR(
        Log(threshold.model, threshold.set_by, threshold.set_utc_us, ScoreJson(threshold.min_score)));
    return change.Commit();
  }

  Status Remove(const std::string& model, const std::string& actor, std::int64_t now_us) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t removed,
                                database_->Write("DELETE FROM thresholds WHERE model_name = ?", ValueList(model)));
    if (removed == 0) return {};
    VICTORIOUS_RETURN_IF_ERROR(Log(model, actor, now_us, nullptr));
    return change.Commit();
  }

  Expected<std::vector<ModelDecisions>> Decisions() override {
    std::map<std::int64_t, std::vector<DecidedScore>> by_model;
    VICTORIOUS_RETURN_IF_ERROR(database_->Visit(
        fmt::format("SELECT model_id, order_score, verdict FROM objects{} WHERE is_listed = 1 AND verdict IS NOT NULL "
                    "ORDER BY order_score, order_frames, id",
                    IndexedBy(database_->dialect(), "objects_by_rank")),
        ValueList(), RowCount::kMany, [&](const Row& row) -> Expected<bool> {
          by_model[row.Integer(0)].push_back({-row.Real(1), row.Text(2) == ToText(Verdict::kAccepted)});
          return true;
        }));
    std::vector<ModelDecisions> all;
    for (auto& [model, decisions] : by_model) all.push_back({model, std::move(decisions)});
    return all;
  }

 private:
  Status Log(const std::string& model, const std::string& actor, std::int64_t now_us, const Json& min_score) {
    return AddAudit(*database_, {.time_utc_us = now_us,
                                 .actor = actor,
                                 .action = "threshold",
                                 .subject = "model " + model,
                                 .detail = DumpJson(Json({{"min_score", min_score}}))});
  }

  std::unique_ptr<Database> database_;
};

}  // namespace

std::unique_ptr<ThresholdStore> MakeThresholdStore(std::unique_ptr<Database> database) {
  return std::make_unique<SqlThresholdStore>(std::move(database));
}

}  // namespace victorious::sql

namespace victorious {

Expected<std::unique_ptr<ThresholdStore>> OpenThresholdStore(const std::string& name, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto database, sql::OpenDatabase(name, mode));
  return sql::MakeThresholdStore(std::move(database));
}

}  // namespace victorious
