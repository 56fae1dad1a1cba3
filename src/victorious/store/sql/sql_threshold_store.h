// ThresholdStore in a SQL database.
#pragma once

#include <memory>

#include "victorious/store/sql/database.h"
#include "victorious/store/threshold_store.h"

namespace victorious::sql {

[[nodiscard]] std::unique_ptr<ThresholdStore> MakeThresholdStore(std::unique_ptr<Database> database);

}  // namespace victorious::sql
