#include "victorious/show/export/export_map.h"

#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/place_ellipse.h"
#include "victorious/show/export/xml_text.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

Json PositionJson(const GeodeticPoint& point) {
  return {GeodeticJson(point.longitude_rad), GeodeticJson(point.latitude_rad)};
}

Json FeatureJson(const ListedObject& listed) {
  const Geolocation& place = *listed.object.place;
  Json point = PositionJson(place.point);
  point.push_back(MetresJson(place.point.altitude_m));
  Json polygons = Json::array();
  for (const GeodeticRing& ring : ComputeEllipse(place)) {
    Json border = Json::array();
    for (const GeodeticPoint& corner : ring) border.push_back(PositionJson(corner));
    polygons.push_back(Json::array({std::move(border)}));
  }
  const Json ellipse = polygons.size() == 1 ? Json{{"type", "Polygon"}, {"coordinates", polygons.front()}}
                                            : Json{{"type", "MultiPolygon"}, {"coordinates", polygons}};
  const Json geometries = Json::array({{{"type", "Point"}, {"coordinates", std::move(point)}}, ellipse});
  return {{"type", "Feature"},
          {"id", listed.object.id},
          {"geometry", {{"type", "GeometryCollection"}, {"geometries", geometries}}},
          {"properties", ObjectJson(listed)}};
}

std::string CoordinatesText(const GeodeticPoint& point) {
  return fmt::format("{:.9f},{:.9f}", DegreesFromRadians(point.longitude_rad), DegreesFromRadians(point.latitude_rad));
}

std::string PlacemarkText(const ListedObject& listed) {
  // A date that is not known is left out: a viewer would show the object at another time.
  std::string times;
  if (const std::optional<UtcSpan> span = SpanOf(listed.moments)) {
    times = fmt::format("<TimeSpan><begin>{}</begin><end>{}</end></TimeSpan>", FormatUtc(span->begin_us, kUtcDecimals),
                        FormatUtc(span->end_us, kUtcDecimals));
  }
  const Geolocation& place = *listed.object.place;
  std::string ellipse;
  for (const GeodeticRing& ring : ComputeEllipse(place)) {
    ellipse += "<Polygon><outerBoundaryIs><LinearRing><coordinates>";
    for (const GeodeticPoint& corner : ring) ellipse += CoordinatesText(corner) + " ";
    ellipse += "</coordinates></LinearRing></outerBoundaryIs></Polygon>";
  }
  std::string heading;
  if (listed.object.heading_rad) {
    heading = fmt::format(", heading {:.0f}°", DegreesFromRadians(*listed.object.heading_rad));
  }
  const std::string& why = listed.object.rejected;
  const std::string rejected = why.empty() ? "" : ", rejected: " + EscapedXml(why);
  return fmt::format(
      "<Placemark id=\"object-{}\"><name>{} {}</name>"
      "<description>score {:.3f}, {} frames, within {:.2f} m in 90 %{}{}</description>"
      "{}<styleUrl>#object</styleUrl><MultiGeometry>"
      "<Point><coordinates>{}</coordinates></Point>"
      "{}</MultiGeometry></Placemark>\n",
      listed.object.id, EscapedXml(listed.model), listed.object.id, listed.object.score, listed.object.frames,
      place.ce90_m, heading, rejected, times, CoordinatesText(place.point), ellipse);
}

Status WriteGeoJson(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  out << R"({"type":"FeatureCollection","features":[)";
  const char* between = "\n";
  for (const ListedObject& object : objects) {
    if (!object.object.place) continue;
    out << std::exchange(between, ",\n") << DumpJson(FeatureJson(object));
  }
  out << "]}\n";
  return {};
}

Status WriteKml(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>"
         "<Style id=\"object\"><PolyStyle><color>4000ffff</color></PolyStyle></Style>\n";
  for (const ListedObject& object : objects) {
    if (object.object.place) out << PlacemarkText(object);
  }
  out << "</Document></kml>\n";
  return {};
}

}  // namespace

constinit const ExportFormat kGeoJsonFormat{
    .name = "geojson",
    .file = "a GeoJSON FeatureCollection",
    .is_map = true,
    .is_file = [](std::string_view head) { return IsJsonWith(head, {"\"FeatureCollection\""}); },
    .write = &WriteGeoJson};

constinit const ExportFormat kKmlFormat{.name = "kml",
                                        .file = "a KML file",
                                        .is_map = true,
                                        .is_file = [](std::string_view head) { return head.contains("<kml"); },
                                        .write = &WriteKml};

}  // namespace victorious
