// JSON values shared by the export formats: numbers rounded to their significant decimals.
#pragma once

#include <string>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"

namespace victorious {

/// JSON that keeps the insertion order of keys.
using Json = nlohmann::ordered_json;

/// s, to the microsecond
Json TimeJson(double time_s);
/// To four decimals
Json ScoreJson(double score);
/// Degrees, to six decimals
Json DegreesJson(double angle_rad);
/// m or m/s, to the millimetre
Json MetresJson(double value_m);
/// Latitude or longitude in degrees, to a tenth of a millimetre
Json GeodeticJson(double angle_rad);
/// [x, y, w, h]
Json BoxJson(const Box& box);
/// [[x, y], …]
Json OutlineJson(const Polygon& outline);
/// Rows of a matrix
Json MatrixJson(const Eigen::Matrix3d& matrix);
/// px to two decimals
double RoundPixels(double value_px);

}  // namespace victorious
