#include "victorious/store/sqlite/place_functions.h"

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <sqlite3.h>

#include "victorious/base/text.h"
#include "victorious/geometry/geodesy.h"

namespace victorious::sqlite {
namespace {

struct Circle {
  TangentPlane plane;
  double radius_m;
};

struct Area {
  double origin_rad = 0;  // longitude of the first corner
  std::vector<double> latitudes_rad;
  std::vector<double> longitudes_rad;  // relative to `origin_rad`
};

// What a statement's constant arguments mean, made at its first row. Null: no memory.
template <typename T, typename Make>
const T* Prepared(sqlite3_context* context, int argument, const Make& make) {
  if (const void* kept = sqlite3_get_auxdata(context, argument); kept != nullptr) return static_cast<const T*>(kept);
  const auto remove = [](void* kept) { delete static_cast<T*>(kept); };
  sqlite3_set_auxdata(context, argument, new T(make()), remove);
  return static_cast<const T*>(sqlite3_get_auxdata(context, argument));
}

void IsWithin(sqlite3_context* context, int /*count*/, sqlite3_value** values) {
  const Circle* const circle = Prepared<Circle>(context, 2, [&] {
    return Circle{TangentPlane({sqlite3_value_double(values[2]), sqlite3_value_double(values[3]),
                                sqlite3_value_double(values[4])}),
                  sqlite3_value_double(values[5])};
  });
  if (circle == nullptr) return sqlite3_result_error_nomem(context);
  const GeodeticPoint point{sqlite3_value_double(values[0]), sqlite3_value_double(values[1]),
                            circle->plane.origin().altitude_m};
  sqlite3_result_int(context, circle->plane.EnuFromGeodetic(point).norm() <= circle->radius_m ? 1 : 0);
}

Area ReadArea(std::string_view text) {
  Area area;
  std::vector<double> numbers;
  for (const std::string& cell : SplitRow(text)) numbers.push_back(ParseNumber(cell).value_or(0));
  if (numbers.size() < 2) return area;
  area.origin_rad = numbers[1];
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    area.latitudes_rad.push_back(numbers[i]);
    area.longitudes_rad.push_back(std::remainder(numbers[i + 1] - area.origin_rad, 2 * std::numbers::pi));
  }
  return area;
}

bool IsInArea(const Area& area, double latitude_rad, double longitude_rad) {
  const double x = std::remainder(longitude_rad - area.origin_rad, 2 * std::numbers::pi);
  bool is_inside = false;
  for (std::size_t i = 0; i < area.latitudes_rad.size(); ++i) {
    const std::size_t before = i > 0 ? i - 1 : area.latitudes_rad.size() - 1;
    const double y1 = area.latitudes_rad[before];
    const double y2 = area.latitudes_rad[i];
    if ((y1 > latitude_rad) == (y2 > latitude_rad)) continue;
    const double x1 = area.longitudes_rad[before];
    const double x2 = area.longitudes_rad[i];
    if (x < x1 + (latitude_rad - y1) / (y2 - y1) * (x2 - x1)) is_inside = !is_inside;
  }
  return is_inside;
}

void IsInside(sqlite3_context* context, int /*count*/, sqlite3_value** values) {
  const Area* const area = Prepared<Area>(context, 2, [&] {
    const auto* const text = reinterpret_cast<const char*>(sqlite3_value_text(values[2]));
    return ReadArea(text != nullptr ? std::string_view(text, static_cast<std::size_t>(sqlite3_value_bytes(values[2])))
                                    : std::string_view());
  });
  if (area == nullptr) return sqlite3_result_error_nomem(context);
  const bool is_inside = IsInArea(*area, sqlite3_value_double(values[0]), sqlite3_value_double(values[1]));
  sqlite3_result_int(context, is_inside ? 1 : 0);
}

}  // namespace

bool AddPlaceFunctions(sqlite3* connection) {
  constexpr int kFlags = SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_DIRECTONLY;
  const auto add = [&](const char* name, int arguments, void (*function)(sqlite3_context*, int, sqlite3_value**)) {
    return sqlite3_create_function(connection, name, arguments, kFlags, nullptr, function, nullptr, nullptr) ==
           SQLITE_OK;
  };
  return add("is_within", 6, &IsWithin) && add("is_inside", 3, &IsInside);
}

}  // namespace victorious::sqlite
