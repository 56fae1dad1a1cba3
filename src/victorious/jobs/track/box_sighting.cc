#include "victorious/jobs/track/box_sighting.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/types/index_records.h"
#include "victorious/types/json_values.h"

namespace victorious {

std::string BoxName(std::size_t box_index) { return fmt::format("box-{}", box_index + 1); }

std::string ToJsonLines(std::span<const BoxSighting> sightings, std::span<const std::string> videos,
                        std::span<const UserBox> boxes) {
  std::string text;
  for (const BoxSighting& sighting : sightings) {
    const std::string& type = boxes[sighting.box_index].type;
    Json line{{"object_id", sighting.box_index + 1},
              {"model", BoxName(sighting.box_index)},
              {"category", nullptr},
              {"type", type.empty() ? Json() : Json(type)},
              {"video", videos[sighting.video]},
              {"frame", sighting.frame},
              {"time_s", TimeJson(sighting.time_s)},
              {"box", BoxJson(sighting.box)},
              {"score", ScoreJson(sighting.score)},
              {"source", ToText(sighting.matches ? SightingSource::kRecognised : SightingSource::kTracked)},
              {"matches", OrNull(sighting.matches)},
              {"view", nullptr}};
    const std::optional<Geolocation>& place = sighting.place;
    line["latitude_deg"] = place ? GeodeticJson(place->point.latitude_rad) : Json();
    line["longitude_deg"] = place ? GeodeticJson(place->point.longitude_rad) : Json();
    line["altitude_m"] = place ? MetresJson(place->point.altitude_m) : Json();
    line["ce90_m"] = place ? MetresJson(place->ce90_m) : Json();
    line["le90_m"] = place ? MetresJson(place->le90_m) : Json();
    line["speed_m_s"] = place && place->velocity_enu ? MetresJson(place->velocity_enu->norm()) : Json();
    text += DumpJson(line) + "\n";
  }
  return text;
}

}  // namespace victorious
