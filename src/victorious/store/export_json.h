// What the export formats share: numbers with as many decimals as they are worth.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"

namespace victorious {

/// Keeps the order in which keys are added.
using Json = nlohmann::ordered_json;

Json TimeJson(double time_s);
Json ScoreJson(double score);
Json DegreesJson(double angle_rad);
/// m or m/s, to the millimetre
Json MetresJson(double value_m);
/// Latitude or longitude in degrees, to a tenth of a millimetre
Json GeodeticJson(double angle_rad);
/// [x, y, w, h]
Json BoxJson(const Box& box);
/// [[x, y], …]
Json OutlineJson(const Polygon& outline);
/// px to two decimals
double RoundPixels(double value_px);

/// What is not known is null.
Json OrNull(const std::optional<double>& value, Json (*convert)(double));

/// On one line; bytes that are not UTF-8 become U+FFFD.
std::string Dump(const Json& json);

}  // namespace victorious
