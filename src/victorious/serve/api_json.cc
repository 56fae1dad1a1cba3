#include "victorious/serve/api_json.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "victorious/base/version.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

Json PlaceToJson(const Geolocation& place) {
  const EllipseAxes ellipse = ComputeEllipseAxes(place.covariance_enu_m2);
  return {{"time_s", TimeJson(place.time_s)},
          {"latitude_deg", GeodeticJson(place.point.latitude_rad)},
          {"longitude_deg", GeodeticJson(place.point.longitude_rad)},
          {"altitude_m", MetresJson(place.point.altitude_m)},
          {"ce90_m", MetresJson(place.ce90_m)},
          {"le90_m", MetresJson(place.le90_m)},
          {"ellipse",
           {{"semi_major_m", MetresJson(ellipse.semi_major_m)},
            {"semi_minor_m", MetresJson(ellipse.semi_minor_m)},
            {"azimuth_deg", DegreesJson(ellipse.azimuth_rad)}}}};
}

Json PointToJson(const GeodeticPoint& point) {
  return Json::array({GeodeticJson(point.longitude_rad), GeodeticJson(point.latitude_rad)});
}

}  // namespace

EllipseAxes ComputeEllipseAxes(const Eigen::Matrix3d& covariance_enu_m2) {
  constexpr double kRadius = 2.145966026289347;  // sqrt(-2 ln 0.1), in standard deviations: 90 % of a 2D normal
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_enu_m2.topLeftCorner<2, 2>());
  const Eigen::Vector2d lengths = kRadius * axes.eigenvalues().cwiseMax(0).cwiseSqrt();
  const Eigen::Vector2d longer = axes.eigenvectors().col(1);
  double azimuth = std::atan2(longer.x(), longer.y());
  if (azimuth < 0) azimuth += kPi;
  if (azimuth >= kPi) azimuth -= kPi;
  return {lengths[1], lengths[0], azimuth};
}

Json ReviewToJson(const Review* review) {
  if (review == nullptr || review->IsEmpty()) return nullptr;
  return {{"verdict", review->verdict ? Json(ToText(*review->verdict)) : Json()},
          {"note", review->note},
          {"updated_utc_us", review->updated_utc_us}};
}

Json ObjectToJson(const ListedObject& listed, const IndexSnapshot& snapshot) {
  const ObjectRecord& object = listed.object;
  Json moments = Json::array();
  if (const auto found = snapshot.lists->moments.find(object.id); found != snapshot.lists->moments.end()) {
    for (const TrackletRecord& one : found->second) {
      moments.push_back({{"video_id", one.video},
                         {"first_time_s", TimeJson(one.first_time_s)},
                         {"last_time_s", TimeJson(one.last_time_s)},
                         {"frames", one.frames},
                         {"score", ScoreJson(one.score)}});
    }
  }
  const auto review = snapshot.reviews->find(object.id);
  return {{"id", object.id},
          {"rank", listed.rank},
          {"model_id", object.model},
          {"model", listed.model},
          {"score", ScoreJson(object.score)},
          {"frames", object.frames},
          {"first_time_s", TimeJson(object.first_time_s)},
          {"last_time_s", TimeJson(object.last_time_s)},
          {"moments", std::move(moments)},
          {"place", object.place ? PlaceToJson(*object.place) : Json()},
          {"heading_deg", OrNull(object.heading_rad, &DegreesJson)},
          {"speed_m_s", OrNull(ComputeSpeed(object), &MetresJson)},
          {"review", ReviewToJson(review == snapshot.reviews->end() ? nullptr : &review->second)}};
}

Json SightingToJson(const SightingRecord& sighting) {
  std::optional<double> heading_rad;
  if (sighting.observation) heading_rad = sighting.observation->heading_rad;
  return {{"video_id", sighting.video},
          {"object_id", sighting.object},
          {"frame", sighting.frame},
          {"time_s", TimeJson(sighting.time_s)},
          {"box", BoxJson(sighting.box)},
          {"outline", OutlineJson(sighting.outline)},
          {"score", ScoreJson(sighting.score)},
          {"source", ToText(sighting.source)},
          {"matches", sighting.matches},
          {"view_index", sighting.view_index},
          {"distance_m", OrNull(sighting.distance_m, &MetresJson)},
          {"sigma_distance_m", OrNull(sighting.sigma_distance_m, &MetresJson)},
          {"heading_deg", OrNull(heading_rad, &DegreesJson)}};
}

Json VideoToJson(const VideoRecord& video, const IndexLists& lists, const std::string& missing) {
  Json searches = Json::array();
  for (const SearchRecord& search : std::ranges::equal_range(lists.searches, video.id, {}, &SearchRecord::video)) {
    searches.push_back(
        {{"model_id", search.model}, {"searched_frames", search.next_frame}, {"finished", search.finished}});
  }
  const auto objects = lists.objects_of_video.find(video.id);
  return {{"id", video.id},
          {"name", video.name},
          {"width_px", video.width},
          {"height_px", video.height},
          {"frame_count", video.frame_count ? Json(*video.frame_count) : Json()},
          {"duration_s", OrNull(video.duration_s, &TimeJson)},
          {"start_utc_us", video.start_utc_us ? Json(*video.start_utc_us) : Json()},
          {"objects", objects == lists.objects_of_video.end() ? 0 : objects->second},
          {"missing", missing.empty() ? Json() : Json(missing)},
          {"searches", std::move(searches)}};
}

Json ProjectToJson(const std::filesystem::path& index, const IndexSnapshot& snapshot, bool can_review, bool has_views) {
  const IndexLists& lists = *snapshot.lists;
  std::map<std::int64_t, std::int64_t> objects_of_model;
  std::int64_t accepted = 0;
  std::int64_t rejected = 0;
  for (const ListedObject& one : lists.objects) {
    ++objects_of_model[one.object.model];
    const auto review = snapshot.reviews->find(one.object.id);
    if (review == snapshot.reviews->end()) continue;
    accepted += review->second.verdict == Verdict::kAccepted;
    rejected += review->second.verdict == Verdict::kRejected;
  }
  Json models = Json::array();
  for (const ModelRecord& model : lists.models) {
    models.push_back({{"id", model.id},
                      {"name", model.name},
                      {"kind", ToText(model.kind)},
                      {"objects", objects_of_model[model.id]}});
  }
  const auto objects = static_cast<std::int64_t>(lists.objects.size());
  return {{"name", index.filename().string()},
          {"version", kVersion},
          {"can_review", can_review},
          {"has_views", has_views},
          {"videos", lists.videos.size()},
          {"objects", objects},
          {"accepted", accepted},
          {"rejected", rejected},
          {"unreviewed", objects - accepted - rejected},
          {"models", std::move(models)}};
}

Json CameraPathToJson(const CameraPath& path) {
  Json points = Json::array();
  for (const CameraPathPoint& point : path.points) {
    Json footprint;
    if (point.footprint) {
      footprint = Json::array();
      for (const GeodeticPoint& corner : *point.footprint) footprint.push_back(PointToJson(corner));
    }
    points.push_back({{"time_s", TimeJson(point.time_s)},
                      {"position", PointToJson(point.place)},
                      {"altitude_m", MetresJson(point.place.altitude_m)},
                      {"yaw_deg", OrNull(point.yaw_rad, &DegreesJson)},
                      {"footprint", std::move(footprint)}});
  }
  return {{"source", path.source.empty() ? Json() : Json(path.source)},
          {"reason", path.reason.empty() ? Json() : Json(path.reason)},
          {"ground_m", OrNull(path.ground_m, &MetresJson)},
          {"points", std::move(points)}};
}

}  // namespace victorious
