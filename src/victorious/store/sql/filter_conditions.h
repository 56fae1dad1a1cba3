// The conditions of a SightingFilter as SQL that every database of the store reads.
#pragma once

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sql/conditions.h"
#include "victorious/store/sql/dialect.h"

namespace victorious::sql {

/// The conditions of SelectObjects(). `store` lists the videos, if the filter names one: names are compared here,
/// because SQL does not know path components.
[[nodiscard]] Expected<Conditions> ObjectConditions(IndexStore& store, const SightingFilter& filter, Dialect dialect);
/// The conditions of SelectSightings().
[[nodiscard]] Expected<Conditions> SightingConditions(IndexStore& store, const SightingFilter& filter, Dialect dialect);
/// The conditions of SelectKeptFrames().
[[nodiscard]] Expected<Conditions> KeptFrameConditions(IndexStore& store, const SightingFilter& filter);

}  // namespace victorious::sql
