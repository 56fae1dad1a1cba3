// The conditions of a SightingFilter as SQL that every database of the store reads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"
#include "victorious/store/sql/conditions.h"

namespace victorious::sql {

/// The ids of the objects within SightingFilter::near; std::nullopt if the filter has none.
using NearIds = std::optional<std::vector<std::int64_t>>;

/// The conditions of SelectObjects(). `store` lists the videos, if the filter names one: names are compared here,
/// because SQL does not know path components.
[[nodiscard]] Expected<Conditions> ObjectConditions(IndexStore& store, const SightingFilter& filter,
                                                    const NearIds& near);
/// The conditions of SelectSightings().
[[nodiscard]] Expected<Conditions> SightingConditions(IndexStore& store, const SightingFilter& filter,
                                                      const NearIds& near);
/// The conditions of SelectKeptFrames().
[[nodiscard]] Expected<Conditions> KeptFrameConditions(IndexStore& store, const SightingFilter& filter);

/// True if a point lies within the circle, on the ground: heights are ignored.
[[nodiscard]] bool IsWithin(const GeoCircle& circle, double latitude_rad, double longitude_rad);

}  // namespace victorious::sql
