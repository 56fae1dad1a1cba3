#include "victorious/store/sql/audit.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/types/json_values.h"

namespace victorious::sql {

Status AddAudit(Database& database, const AuditRecord& record) {
  const auto added = database.Write(std::string(kInsertAudit), ValueList(record.time_utc_us, record.actor,
                                                                         record.action, record.subject, record.detail));
  if (!added) return std::unexpected(added.error());
  return {};
}

AuditRecord AuditOfReview(std::int64_t object, const Review& review, const std::string& model, const std::string& video,
                          std::int64_t frame) {
  Json detail;
  detail["verdict"] = review.verdict ? Json(ToText(*review.verdict)) : Json();
  detail["note"] = review.note;
  detail["model"] = model;
  detail["video"] = video;
  detail["frame"] = frame;
  return {.id = 0,
          .time_utc_us = review.updated_utc_us,
          .actor = review.reviewer,
          .action = "review",
          .subject = fmt::format("object {}", object),
          .detail = DumpJson(detail)};
}

AuditRecord AuditOfGroups(std::int64_t correction, const TrackletGroups& groups) {
  Json detail = Json::object();
  if (!groups.groups.empty()) detail["moments"] = groups.groups;
  return {.id = 0,
          .time_utc_us = groups.made_utc_us,
          .actor = groups.author,
          .action = groups.groups.empty() ? "undo_regroup" : "regroup",
          .subject = fmt::format("correction {}", correction),
          .detail = DumpJson(detail)};
}

}  // namespace victorious::sql
