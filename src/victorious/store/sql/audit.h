// Entries of the log of who did what (audit_record.h).
#pragma once

#include "victorious/base/error.h"
#include "victorious/store/audit_record.h"
#include "victorious/store/sql/database.h"

namespace victorious::sql {

/// An INSERT of one entry. Parameters: time_utc_us, actor, action, subject, detail.
inline constexpr std::string_view kInsertAudit =
    "INSERT INTO audit (time_utc_us, actor, action, subject, detail) VALUES (?, ?, ?, ?, ?)";

/// Adds an entry; its id is ignored.
[[nodiscard]] Status AddAudit(Database& database, const AuditRecord& record);

/// The entry of a review of an object. The place says which object it was after its id has changed.
/// @param model, video, frame  of the place that the review is bound to; the video by its content id
[[nodiscard]] AuditRecord AuditOfReview(std::int64_t object, const Review& review, const std::string& model,
                                        const std::string& video, std::int64_t frame);

/// The entry of what a person says of the identity of tracklets; without groups, of taking that back.
[[nodiscard]] AuditRecord AuditOfGroups(std::int64_t correction, const TrackletGroups& groups);

}  // namespace victorious::sql
