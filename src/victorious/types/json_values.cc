#include "victorious/types/json_values.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Rounds to the nearest multiple of 1 / `parts`; converts -0 to 0. Dump writes values that are not finite as null.
double Round(double value, double parts) { return std::round(value * parts) / parts + 0.0; }

}  // namespace

Json TimeJson(double time_s) { return Round(time_s, 1e6); }

Json ScoreJson(double score) { return Round(score, 1e4); }

Json DegreesJson(double angle_rad) { return Round(DegreesFromRadians(angle_rad), 1e6); }

Json MetresJson(double value_m) { return Round(value_m, 1e3); }

Json GeodeticJson(double angle_rad) { return Round(DegreesFromRadians(angle_rad), 1e9); }

double RoundPixels(double value_px) { return Round(value_px, 1e2); }

Json BoxJson(const Box& box) {
  return Json::array({RoundPixels(box.x), RoundPixels(box.y), RoundPixels(box.width), RoundPixels(box.height)});
}

Json OutlineJson(const Polygon& outline) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : outline) {
    corners.push_back(Json::array({RoundPixels(corner.x()), RoundPixels(corner.y())}));
  }
  return corners;
}

Json MatrixJson(const Eigen::Matrix3d& matrix) {
  Json rows = Json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back({row.x(), row.y(), row.z()});
  return rows;
}

}  // namespace victorious
