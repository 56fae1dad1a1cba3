#include "victorious/show/export/export_czml.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/show/export/place_ellipse.h"
#include "victorious/types/json_values.h"

namespace victorious {
namespace {

Json Rgba(int opacity) { return {{"rgba", {255, 213, 0, opacity}}}; }

void AddPosition(Json& degrees, const GeodeticPoint& point) {
  degrees.push_back(GeodeticJson(point.longitude_rad));
  degrees.push_back(GeodeticJson(point.latitude_rad));
  degrees.push_back(MetresJson(point.altitude_m));
}

Json PositionsJson(std::span<const GeodeticPoint> points) {
  Json degrees = Json::array();
  for (const GeodeticPoint& point : points) AddPosition(degrees, point);
  return {{"cartographicDegrees", std::move(degrees)}};
}

// Cesium reads neither null nor plain arrays as properties: what is known, and has one value.
Json PropertiesJson(const ListedObject& listed) {
  Json properties = Json::object();
  const Json all = ObjectJson(listed);
  for (const auto& [key, value] : all.items()) {
    if (value.is_primitive() && !value.is_null()) properties[key] = value;
  }
  return properties;
}

// From its first to its last sighting; what is seen in one frame for a second. Null: a video does not tell UTC.
Json AvailabilityJson(const ListedObject& listed) {
  constexpr std::int64_t kShown_us = 1'000'000;
  const std::optional<UtcSpan> span = SpanOf(listed.moments);
  if (!span) return nullptr;
  return FormatUtc(span->begin_us, kUtcDecimals) + "/" +
         FormatUtc(std::max(span->end_us, span->begin_us + kShown_us), kUtcDecimals);
}

Json WithAvailability(Json packet, const Json& availability) {
  if (!availability.is_null()) packet["availability"] = availability;
  return packet;
}

Json PacketJson(const ListedObject& listed) {
  const std::string name = fmt::format("{} {}", listed.model, listed.object.id);
  return {{"id", fmt::format("object-{}", listed.object.id)},
          {"name", name},
          {"position", PositionsJson(std::span(&listed.object.place->point, 1))},
          {"point", {{"pixelSize", 9}, {"color", Rgba(255)}}},
          {"label", {{"text", name}, {"font", "12px sans-serif"}, {"pixelOffset", {{"cartesian2", {0, -16}}}}}},
          {"properties", PropertiesJson(listed)}};
}

// The ellipse, as the other maps draw it: one polygon, or two where the antimeridian cuts it.
Json EllipseJson(const ListedObject& listed, const GeodeticRing& ring, std::size_t part) {
  return {{"id", fmt::format("object-{}-ellipse-{}", listed.object.id, part)},
          {"parent", fmt::format("object-{}", listed.object.id)},
          {"polygon",
           {{"positions", PositionsJson(ring)},
            {"perPositionHeight", true},
            {"material", {{"solidColor", {{"color", Rgba(64)}}}}}}}};
}

Status WriteCzml(const ExportRequest& request, std::ostream& out) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ListedObject> objects,
                              ListObjects(request.store, request.catalogue, request.filter));
  out << "[" << DumpJson(Json{{"id", "document"}, {"name", "victorious"}, {"version", "1.0"}});
  for (const ListedObject& listed : objects) {
    if (!listed.object.place) continue;
    const Json availability = AvailabilityJson(listed);
    out << ",\n" << DumpJson(WithAvailability(PacketJson(listed), availability));
    const std::vector<GeodeticRing> rings = ComputeEllipse(*listed.object.place);
    for (std::size_t part = 0; part < rings.size(); ++part) {
      out << ",\n" << DumpJson(WithAvailability(EllipseJson(listed, rings[part], part), availability));
    }
  }
  out << "]\n";
  return {};
}

}  // namespace

constinit const ExportFormat kCzmlFormat{
    .name = "czml",
    .file = "a CZML document of this program",
    .is_map = true,
    .is_file = [](std::string_view head) { return head.starts_with(R"([{"id":"document","name":"victorious")"); },
    .write = &WriteCzml};

}  // namespace victorious
