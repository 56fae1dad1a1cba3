// TriageStore in a SQL database.
#pragma once

#include <memory>

#include "victorious/store/sql/database.h"
#include "victorious/store/triage_store.h"

namespace victorious::sql {

[[nodiscard]] std::unique_ptr<TriageStore> MakeTriageStore(std::unique_ptr<Database> database);

}  // namespace victorious::sql
