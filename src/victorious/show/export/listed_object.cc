#include "victorious/show/export/listed_object.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/geometry/angles.h"
#include "victorious/types/ground_motion.h"

namespace victorious {
Expected<std::vector<ListedObject>> ListObjects(IndexStore& store, const Catalogue& catalogue,
                                                const SightingFilter& filter) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<ObjectRecord> objects, store.Objects(filter));
  // Reads the names again without a filter: another process may have added videos or models, and an object may be in
  // videos that the filter excludes.
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue everything, Catalogue::Read(store, {}));
  VICTORIOUS_ASSIGN_OR_RETURN(MomentsByObject moments, ReadMoments(store, everything));
  std::vector<ListedObject> listed;
  for (ObjectRecord& object : objects) {
    const ModelRecord* model = catalogue.Model(object.model);
    if (model == nullptr) continue;
    std::vector<std::string> videos;
    for (const std::int64_t id : object.videos) {
      if (const VideoRecord* video = everything.Video(id)) videos.push_back(ShownName(*video));
    }
    std::vector<ObjectMoment> seen = std::move(moments[object.id]);
    listed.push_back(
        {std::move(object), listed.size() + 1, model->name, model->IsCategory(), std::move(videos), std::move(seen)});
  }
  return listed;
}

std::optional<double> ComputeSpeed(const ObjectRecord& object) {
  if (!object.place || !object.place->velocity_enu) return std::nullopt;
  return object.place->velocity_enu->norm();
}

Json ObjectJson(const ListedObject& listed) {
  const ObjectRecord& object = listed.object;
  Json json = {{"object_id", object.id},
               {"model", listed.is_category ? Json() : Json(listed.model)},
               {"category", listed.is_category ? Json(listed.model) : Json()},
               {"rank", listed.rank},
               {"score", ScoreJson(object.score)},
               {"videos", listed.videos},
               {"frames", object.frames},
               {"first_time_s", TimeJson(object.first_time_s)},
               {"last_time_s", TimeJson(object.last_time_s)},
               {"place_time_s", nullptr},
               {"latitude_deg", nullptr},
               {"longitude_deg", nullptr},
               {"altitude_m", nullptr},
               {"covariance_enu_m2", nullptr},
               {"ce90_m", nullptr},
               {"le90_m", nullptr},
               {"heading_deg", OrNull(object.heading_rad, &DegreesJson)},
               {"speed_m_s", OrNull(ComputeSpeed(object), &MetresJson)},
               {"sigma_speed_m_s", nullptr},
               {"course_deg", nullptr},
               {"sigma_course_deg", nullptr}};
  if (const auto motion = object.place ? ComputeGroundMotion(*object.place) : std::nullopt) {
    json["sigma_speed_m_s"] = MetresJson(motion->sigma_speed_m_s);
    json["course_deg"] = DegreesJson(motion->course_rad);
    json["sigma_course_deg"] = DegreesJson(motion->sigma_course_rad);
  }
  if (object.place) {
    const Geolocation& place = *object.place;
    json["place_time_s"] = TimeJson(place.time_s);
    json["latitude_deg"] = GeodeticJson(place.point.latitude_rad);
    json["longitude_deg"] = GeodeticJson(place.point.longitude_rad);
    json["altitude_m"] = MetresJson(place.point.altitude_m);
    json["covariance_enu_m2"] = MatrixJson(place.covariance_enu_m2);
    json["ce90_m"] = MetresJson(place.ce90_m);
    json["le90_m"] = MetresJson(place.le90_m);
  }
  json["moments"] = MomentsJson(listed.moments);
  json["against"] = object.against;
  json["evidence"] = ParseStrictJson(object.evidence_json).value_or(nullptr);
  if (!object.rejected.empty()) json["rejected"] = object.rejected;
  if (!object.place_rejected.empty()) json["place_rejected"] = object.place_rejected;
  return json;
}

}  // namespace victorious
