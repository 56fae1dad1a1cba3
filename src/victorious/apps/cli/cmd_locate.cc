// victorious locate LINES.csv
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/base/warning_list.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/geolocate/lines_csv.h"
#include "victorious/place/geolocate/locate.h"
#include "victorious/types/json_values.h"

namespace victorious::cli {
namespace {

struct LocateArguments {
  std::string lines;
  std::string motion;
  std::string method;
  std::string params;
  GroundArguments ground;
  bool json = false;
};

Json ToJson(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

// Clockwise from north, [0, 360).
double CourseDeg(const Eigen::Vector3d& velocity_enu) {
  const double course = DegreesFromRadians(std::atan2(velocity_enu.x(), velocity_enu.y()));
  return course < 0 ? course + 360 : course;
}

// Unknown values are null, never 0.
Json ToJson(const GeoFix& fix) {
  Json json = {{"latitude_deg", nullptr},
               {"longitude_deg", nullptr},
               {"altitude_m", nullptr},
               {"place_time_s", nullptr},
               {"velocity_enu_m_s", nullptr},
               {"speed_m_s", nullptr},
               {"course_deg", nullptr},
               {"covariance_enu_m2", nullptr},
               {"velocity_covariance_enu_m2_s2", nullptr},
               {"ce90_m", nullptr},
               {"le90_m", nullptr}};
  if (fix.place) {
    const Geolocation& place = *fix.place;
    json["latitude_deg"] = DegreesFromRadians(place.point.latitude_rad);
    json["longitude_deg"] = DegreesFromRadians(place.point.longitude_rad);
    json["altitude_m"] = place.point.altitude_m;
    json["place_time_s"] = place.time_s;
    json["covariance_enu_m2"] = MatrixJson(place.covariance_enu_m2);
    json["ce90_m"] = place.ce90_m;
    json["le90_m"] = place.le90_m;
    if (place.velocity_enu) {
      json["velocity_enu_m_s"] = ToJson(*place.velocity_enu);
      json["velocity_covariance_enu_m2_s2"] = MatrixJson(*place.velocity_covariance_enu);
      json["speed_m_s"] = place.velocity_enu->norm();
      json["course_deg"] = CourseDeg(*place.velocity_enu);
    }
  }
  json["inliers"] = fix.inliers;
  json["status"] = StatusText(fix);
  return json;
}

std::string ToText(const GeoFix& fix) {
  if (!fix.place) return StatusText(fix) + "\n";
  const Geolocation& place = *fix.place;
  std::string text = fmt::format("place    {:.7f} {:.7f} deg, {:.2f} m above the ellipsoid, at {:.3f} s\n",
                                 DegreesFromRadians(place.point.latitude_rad),
                                 DegreesFromRadians(place.point.longitude_rad), place.point.altitude_m, place.time_s);
  text += fmt::format("error    CE90 {:.2f} m, LE90 {:.2f} m\n", place.ce90_m, place.le90_m);
  if (place.velocity_enu) {
    text += fmt::format("velocity {:.2f} m/s towards {:.1f} deg\n", place.velocity_enu->norm(),
                        CourseDeg(*place.velocity_enu));
  }
  text += fmt::format("lines    {} of {} are inliers\n", std::ranges::count(fix.inliers, true), fix.inliers.size());
  return text;
}

void WarnAboutRows(const std::vector<std::string>& problems) {
  WarningList ignored;
  for (const std::string& problem : problems) ignored.Add(OneLine(problem) + ": row ignored");
  for (const std::string& line : ignored.Lines()) LogWarning(line);
}

// Expands the inlier flags from the lines that were read to all rows of the file; rows that were not read are outliers.
std::vector<bool> ExpandToRows(const std::vector<bool>& inliers, const std::vector<bool>& row_is_valid) {
  std::vector<bool> by_row;
  std::size_t next = 0;
  for (const bool read : row_is_valid) by_row.push_back(read && inliers[next++]);
  return by_row;
}

Status Run(const LocateArguments& arguments) {
  LocateOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, options));
  if (!arguments.motion.empty()) options.motion = FromText(kMotionModelTexts, arguments.motion).value();
  if (!arguments.method.empty()) options.method = FromText(kLocateMethodTexts, arguments.method).value();
  GroundOptions ground;
  ApplyGround(arguments.ground, ground);
  VICTORIOUS_ASSIGN_OR_RETURN(options.ground, MakeGround(ground, [](const std::string& line) { LogWarning(line); }));
  VICTORIOUS_ASSIGN_OR_RETURN(const LineOfSightTable table, ReadLinesOfSight(arguments.lines));
  VICTORIOUS_ASSIGN_OR_RETURN(GeoFix fix, Locate(table.lines, options));
  WarnAboutRows(table.problems);
  fix.inliers = ExpandToRows(fix.inliers, table.row_is_valid);
  return WriteOutput("", arguments.json ? DumpJson(ToJson(fix), 1) + "\n" : ToText(fix));
}

}  // namespace

Action SetUpLocate(ArgumentParser& parser) {
  const auto arguments = std::make_shared<LocateArguments>();
  parser.Add("LINES", arguments->lines, "Lines of sight (CSV, docs/formats/locate.md)").Required().TypeName("FILE");
  parser.Add("--motion", arguments->motion, "Motion model of the object (default static)").OneOf(kMotionModelTexts);
  parser.Add("--method", arguments->method, "The estimator (default ml)").OneOf(kLocateMethodTexts);
  AddGround(parser, arguments->ground);
  parser.Add("--params", arguments->params, "Parameters (`victorious params locate`)").TypeName("FILE");
  parser.AddFlag("--json", arguments->json, "Print JSON");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
