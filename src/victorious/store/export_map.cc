#include "victorious/store/export_map.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/store/export_json.h"
#include "victorious/store/listed_object.h"

namespace victorious {
namespace {

// The border of the horizontal 90 % confidence ellipse of a normal distribution, counter-clockwise and closed.
std::vector<GeodeticPoint> EllipseOf(const Geolocation& place) {
  constexpr int kCorners = 48;
  constexpr double kRadius = 2.145966026289347;  // sqrt(-2 ln 0.1), in standard deviations: 90 % of a 2D normal
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(place.covariance_enu_m2.topLeftCorner<2, 2>());
  Eigen::Matrix2d directions = axes.eigenvectors();
  if (directions.determinant() < 0) directions.col(1) *= -1;
  const Eigen::Vector2d lengths = kRadius * axes.eigenvalues().cwiseMax(0).cwiseSqrt();
  const TangentPlane plane(place.point);
  std::vector<GeodeticPoint> border;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle = 2 * kPi * (i % kCorners) / kCorners;
    const Eigen::Vector2d corner = directions * lengths.cwiseProduct(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    border.push_back(plane.GeodeticFromEnu({corner.x(), corner.y(), 0}));
  }
  return border;
}

Json PositionJson(const GeodeticPoint& point) {
  return {GeodeticJson(point.longitude_rad), GeodeticJson(point.latitude_rad)};
}

using Ring = std::vector<GeodeticPoint>;

// Clips a closed ring to the part east (`east`) or west of a meridian. Returns a closed ring.
Ring Beside(const Ring& ring, double longitude_rad, bool east) {
  const auto inside = [&](const GeodeticPoint& point) {
    return east ? point.longitude_rad >= longitude_rad : point.longitude_rad <= longitude_rad;
  };
  Ring part;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    const GeodeticPoint& a = ring[i];
    const GeodeticPoint& b = ring[i + 1];
    if (inside(a)) part.push_back(a);
    if (inside(a) == inside(b)) continue;
    const double share = (longitude_rad - a.longitude_rad) / (b.longitude_rad - a.longitude_rad);
    part.push_back({a.latitude_rad + share * (b.latitude_rad - a.latitude_rad), longitude_rad, a.altitude_m});
  }
  if (!part.empty()) part.push_back(part.front());
  return part;
}

// A ring around a place, cut at the antimeridian if it crosses it (RFC 7946, section 3.1.9).
std::vector<Ring> CutAtAntimeridian(Ring ring, double middle_longitude_rad) {
  for (GeodeticPoint& point : ring) {
    point.longitude_rad = middle_longitude_rad + WrapAngle(point.longitude_rad - middle_longitude_rad);
  }
  for (const double edge_rad : {-kPi, kPi}) {
    const auto [west, east] = std::ranges::minmax(ring, {}, &GeodeticPoint::longitude_rad);
    if (!(west.longitude_rad < edge_rad && edge_rad < east.longitude_rad)) continue;
    std::vector<Ring> parts = {Beside(ring, edge_rad, false), Beside(ring, edge_rad, true)};
    Ring& beyond = edge_rad < 0 ? parts.front() : parts.back();
    for (GeodeticPoint& point : beyond) point.longitude_rad -= 2 * edge_rad;
    return parts;
  }
  return {std::move(ring)};
}

std::vector<Ring> RingsOf(const Geolocation& place) {
  return CutAtAntimeridian(EllipseOf(place), place.point.longitude_rad);
}

Json FeatureJson(const ListedObject& listed) {
  const Geolocation& place = *listed.object.place;
  Json point = PositionJson(place.point);
  point.push_back(MetresJson(place.point.altitude_m));
  Json polygons = Json::array();
  for (const Ring& ring : RingsOf(place)) {
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

std::string EscapedXml(const std::string& text) {
  std::string escaped;
  for (const char c : nlohmann::json::parse(Dump(text)).get<std::string>()) {  // replaces bytes that are not UTF-8
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n') {  // the control bytes of XML
      escaped += c;
    }
  }
  return escaped;
}

std::string TimeText(std::int64_t utc_us) {
  const std::chrono::sys_time<std::chrono::milliseconds> time(std::chrono::milliseconds(utc_us / 1000));
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                     (time - seconds).count());
}

std::string CoordinatesText(const GeodeticPoint& point) {
  return fmt::format("{:.9f},{:.9f}", DegreesFromRadians(point.longitude_rad), DegreesFromRadians(point.latitude_rad));
}

struct TimeSpan {
  std::int64_t begin_us = 0;
  std::int64_t end_us = 0;
};

// The times of the first and last sighting of each object, by its id.
Expected<std::map<std::int64_t, TimeSpan>> ReadTimeSpans(IndexStore& store) {
  std::map<std::int64_t, std::int64_t> start_us;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  for (const VideoRecord& video : videos) start_us[video.id] = video.start_utc_us.value_or(0);
  std::map<std::int64_t, TimeSpan> spans;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> tracklets, store.Tracklets());
  for (const TrackletRecord& tracklet : tracklets) {
    const std::int64_t begin_us = start_us[tracklet.video] + std::llround(tracklet.first_time_s * 1e6);
    const std::int64_t end_us = start_us[tracklet.video] + std::llround(tracklet.last_time_s * 1e6);
    const auto [at, added] = spans.emplace(tracklet.object, TimeSpan{begin_us, end_us});
    at->second = {std::min(at->second.begin_us, begin_us), std::max(at->second.end_us, end_us)};
  }
  return spans;
}

std::string PlacemarkText(const ListedObject& listed, const TimeSpan& span) {
  const Geolocation& place = *listed.object.place;
  std::string ellipse;
  for (const Ring& ring : RingsOf(place)) {
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
      "<TimeSpan><begin>{}</begin><end>{}</end></TimeSpan><styleUrl>#object</styleUrl><MultiGeometry>"
      "<Point><coordinates>{},{:.3f}</coordinates></Point>"
      "{}</MultiGeometry></Placemark>\n",
      listed.object.id, EscapedXml(listed.model), listed.object.id, listed.object.score, listed.object.frames,
      place.ce90_m, heading, rejected, TimeText(span.begin_us), TimeText(span.end_us), CoordinatesText(place.point),
      place.point.altitude_m, ellipse);
}

}  // namespace

Status ExportGeoJson(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects, ListObjects(store, catalogue, filter));
  out << R"({"type":"FeatureCollection","features":[)";
  const char* between = "\n";
  for (const ListedObject& object : objects) {
    if (!object.object.place) continue;
    out << std::exchange(between, ",\n") << Dump(FeatureJson(object));
  }
  out << "]}\n";
  return {};
}

Status ExportKml(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects, ListObjects(store, catalogue, filter));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto spans, ReadTimeSpans(store));
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>"
         "<Style id=\"object\"><PolyStyle><color>4000ffff</color></PolyStyle></Style>\n";
  for (const ListedObject& object : objects) {
    const auto span = spans.find(object.object.id);
    if (object.object.place && span != spans.end()) out << PlacemarkText(object, span->second);
  }
  out << "</Document></kml>\n";
  return {};
}

}  // namespace victorious
