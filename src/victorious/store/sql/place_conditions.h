// Conditions of where objects stand, which the database checks itself: no list of ids is read, however many objects a
// region has. SQLite has no geodesy: its connections have the two tests as functions (sqlite/place_functions.h).
// PostgreSQL computes them.
#pragma once

#include <string_view>

#include "victorious/store/index_store.h"
#include "victorious/store/sql/conditions.h"
#include "victorious/store/sql/dialect.h"
#include "victorious/store/triage_store.h"

namespace victorious::sql {

/// Of which objects a condition is met at most.
enum class PlacedObjects { kAll, kListed };

/// Requires the object of alias `o` to stand within the circle on the ground: its height is ignored.
void AddNear(Dialect dialect, const GeoCircle& circle, PlacedObjects objects, Conditions& conditions);

/// Requires the object of alias `o` to stand in the area, by the number of its edges that lie east of the object.
/// Longitudes are compared relative to the first corner's, because an area may cross the antimeridian.
void AddInside(Dialect dialect, const GeoPolygon& area, PlacedObjects objects, Conditions& conditions);

}  // namespace victorious::sql
