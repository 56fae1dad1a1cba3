// SegmentStore in a PostgreSQL database.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "victorious/store/index_store.h"
#include "victorious/store/postgres/connection.h"
#include "victorious/store/segment_store.h"

namespace victorious {

/// Opens the segments of an index that exists. Errors: those of OpenPostgresStore.
/// @param task  see Connection::Open
[[nodiscard]] Expected<std::unique_ptr<SegmentStore>> OpenPostgresSegmentStore(const std::string& url, StoreMode mode,
                                                                               std::optional<TaskAttempt> task = {});

/// @param connection  of an index of this version
[[nodiscard]] std::unique_ptr<SegmentStore> MakePostgresSegmentStore(std::shared_ptr<postgres::Connection> connection);

}  // namespace victorious
