// The tests of places in SQL (sql/place_conditions.h), which SQLite has no functions for.
#pragma once

struct sqlite3;

namespace victorious::sqlite {

/// Adds to a connection:
///   is_within(latitude, longitude, centre_latitude, centre_longitude, altitude, radius): radians, m
///   is_inside(latitude, longitude, corners): radians; the corners are "lat,lon,lat,lon,…"
/// Only the program's own statements may call them, not the schema of a file. False: no memory.
[[nodiscard]] bool AddPlaceFunctions(sqlite3* connection);

}  // namespace victorious::sqlite
