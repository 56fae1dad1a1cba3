#include "victorious/apps/serve/api_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <ranges>
#include <span>

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/job_runner.h"
#include "victorious/base/credentials.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/base/version.h"
#include "victorious/base/without_folders.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/drawn_video.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/store/video_coverage.h"

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

Json PixelsToJson(const Eigen::Vector2d& point_px) {
  return Json::array({RoundPixels(point_px.x()), RoundPixels(point_px.y())});
}

Json BaseMapToJson(const BaseMap& map) {
  if (map.IsNone()) return nullptr;
  return {{"url", map.url.empty() ? Json() : Json(map.url)},
          {"is_vector", map.is_vector},
          {"max_zoom", map.max_zoom},
          {"attribution", map.attribution.empty() ? Json() : Json(map.attribution)}};
}

// What a user may fetch. A file may have been removed since it was made.
Json FilesOf(const JobRecord& job) {
  Json files = Json::array();
  if (job.kind == JobKind::kCopy || job.state != WorkState::kDone) return files;
  const auto made = MadeFileOf(job);
  std::error_code error;
  if (!made || !std::filesystem::exists(*made, error)) return files;
  files.push_back(job.kind == JobKind::kRefine ? "categories" : ToText(job.kind));
  if (job.kind != JobKind::kClip) return files;
  if (std::filesystem::exists(ClipTelemetryPath(*made), error)) files.push_back("telemetry");
  return files;
}

// The video that a track belongs to, or that is searched again.
Json VideoIdOf(const JobRecord& job) {
  if (job.kind != JobKind::kTrack && job.kind != JobKind::kIndex) return nullptr;
  const auto input = ParseJson(job.input_json);
  return input && input->is_object() ? Json(input->value("video_id", nlohmann::json())) : Json();
}

Json IntervalsToJson(const std::vector<TimeInterval>& intervals) {
  Json rows = Json::array();
  for (const TimeInterval& one : intervals) {
    rows.push_back({{"from_s", TimeJson(one.from_s)}, {"to_s", TimeJson(one.to_s)}});
  }
  return rows;
}

Json LeftOutToJson(const std::vector<LeftOutTime>& times) {
  Json rows = Json::array();
  for (const LeftOutTime& one : times) {
    rows.push_back({{"from_s", TimeJson(one.from_s)},
                    {"to_s", OrNull(one.to_s, &TimeJson)},
                    {"reason", ToText(one.reason)},
                    {"model_ids", one.models.empty() ? Json() : Json(one.models)}});
  }
  return rows;
}

// What each search has covered of a video.
Json SearchesToJson(const VideoRecord& video, std::span<const SearchRecord> searches,
                    std::span<const SearchPart> parts) {
  Json rows = Json::array();
  for (const SearchRecord& search : searches) {
    const auto own = std::ranges::equal_range(parts, search.model, {}, &SearchPart::model);
    const SearchCoverage coverage = CoverageOf(video, &search, own);
    Json left_out = LeftOutToJson(coverage.left_out);
    for (Json& one : left_out) one.erase("model_ids");
    rows.push_back({{"model_id", search.model},
                    {"searched_frames", coverage.frames},
                    {"finished", search.finished},
                    {"searched", IntervalsToJson(coverage.searched)},
                    {"left_out", std::move(left_out)}});
  }
  return rows;
}

}  // namespace

Json AuditToJson(const std::vector<AuditRecord>& records) {
  Json rows = Json::array();
  for (const AuditRecord& one : records) {
    // Written by this program as JSON, or empty.
    const Expected<nlohmann::json> detail = ParseStrictJson(one.detail);
    rows.push_back({{"id", one.id},
                    {"time_utc_us", one.time_utc_us},
                    {"actor", one.actor},
                    {"action", one.action},
                    {"subject", one.subject},
                    {"detail", detail && detail->is_object() ? Json(*detail) : Json()}});
  }
  return {{"entries", std::move(rows)}};
}

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

Json ReviewToJson(const Review& review) {
  if (review.IsEmpty()) return nullptr;
  return {{"verdict", review.verdict ? Json(ToText(*review.verdict)) : Json()},
          {"note", review.note},
          {"reviewer", review.reviewer},
          {"updated_utc_us", review.updated_utc_us}};
}

Json DecisionsToJson(const std::vector<Review>& decisions) {
  Json rows = Json::array();
  for (const Review& one : decisions) rows.push_back(ReviewToJson(one));
  return rows;
}

Json ObjectToJson(const TriageObject& listed, const IndexLists& lists) {
  const ObjectRecord& object = listed.object;
  Json moments = Json::array();
  for (const TrackletRecord& one : listed.moments) {
    moments.push_back({{"id", one.id},
                       {"video_id", one.video},
                       {"first_time_s", TimeJson(one.first_time_s)},
                       {"last_time_s", TimeJson(one.last_time_s)},
                       {"frames", one.frames},
                       {"score", ScoreJson(one.score)}});
  }
  const ModelRecord* model = lists.Model(object.model);
  return {{"id", object.id},
          {"model_id", object.model},
          {"model", model == nullptr ? "" : model->name},
          {"score", ScoreJson(object.score)},
          {"against", object.against},
          {"frames", object.frames},
          {"first_time_s", TimeJson(object.first_time_s)},
          {"last_time_s", TimeJson(object.last_time_s)},
          {"moments", std::move(moments)},
          {"place", object.place ? PlaceToJson(*object.place) : Json()},
          {"heading_deg", OrNull(object.heading_rad, &DegreesJson)},
          {"speed_m_s", OrNull(ComputeSpeed(object), &MetresJson)},
          {"review", ReviewToJson(listed.review)},
          {"decisions", DecisionsToJson(listed.decisions)},
          {"is_disputed", listed.is_disputed}};
}

Json ObjectEvidenceToJson(const std::string& text) {
  constexpr auto kKeys = std::to_array<const char*>({"recognitions", "frames", "by_shape", "missed", "size_ratio",
                                                     "lines", "missing_lines", "place_rejected", "headings",
                                                     "contradicting_headings", "view_spread_deg"});
  const Expected<nlohmann::json> all = ParseStrictJson(text);
  if (!all || !all->is_object()) return nullptr;
  Json known = Json::object();
  for (const char* key : kKeys) {
    const auto found = all->find(key);
    if (found == all->end()) return nullptr;
    known[key] = *found;
  }
  return known;
}

Json CountsToJson(const ObjectCounts& counts) {
  return {{"objects", counts.objects},
          {"accepted", counts.accepted},
          {"rejected", counts.rejected},
          {"unreviewed", counts.objects - counts.accepted - counts.rejected},
          {"scores", counts.scores},
          {"accepted_scores", counts.accepted_scores},
          {"rejected_scores", counts.rejected_scores}};
}

Json SightingToJson(const SightingRecord& sighting) {
  std::optional<double> heading_rad;
  if (sighting.observation) heading_rad = sighting.observation->heading_rad;
  return {{"video_id", sighting.video},
          {"object_id", sighting.object},
          {"model_id", sighting.model},
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

Json EvidenceToJson(const MatchEvidence& evidence, const SightingRecord& sighting, const ModelView& view,
                    const Box& region) {
  constexpr std::size_t kMaxMatches = 2000;
  Json stages = Json::array();
  for (const MatchEvidence::StageCount& one : evidence.stages) {
    stages.push_back({{"name", ToText(kEvidenceStageTexts, one.stage)}, {"matches", one.matches}});
  }
  Json matches = Json::array();
  for (const EvidenceMatch& one : evidence.matches | std::views::take(kMaxMatches)) {
    matches.push_back({{"template", PixelsToJson(one.in_template_px)},
                       {"frame", PixelsToJson(one.in_scene_px)},
                       {"stages", one.stages}});
  }
  const std::optional<Detection>& found = evidence.detection;
  // The image of a rendering shows the whole view, that of a photo its object (object/model/photo_model.cc).
  const Box whole = FrameBox(view.width, view.height);
  const Box shown = view.surface.empty() ? Intersection(BoundingBox(view.outline), whole) : whole;
  return {{"sighting", SightingToJson(sighting)},
          {"region", BoxJson(region)},
          {"view",
           {{"index", sighting.view_index},
            {"image_box", BoxJson(shown)},
            {"outline", OutlineJson(view.outline)},
            {"azimuth_deg", view.angles ? Json(DegreesJson(view.angles->azimuth_rad)) : Json()},
            {"off_nadir_deg", view.angles ? Json(DegreesJson(view.angles->off_nadir_rad)) : Json()}}},
          {"is_relit", evidence.is_relit},
          {"is_pooled", evidence.is_pooled},
          {"stages", std::move(stages)},
          {"matches", std::move(matches)},
          {"is_truncated", evidence.matches.size() > kMaxMatches},
          {"pose", found ? Json({{"outline", OutlineJson(found->outline)},
                                 {"score", ScoreJson(found->score)},
                                 {"neg_log10_nfa", ScoreJson(found->neg_log10_nfa)}})
                         : Json()}};
}

Json ModelViewsToJson(const ObjectModel& model, Json sightings) {
  Json views = Json::array();
  for (const ModelView& view : model.views) {
    views.push_back({{"azimuth_deg", view.angles ? Json(DegreesJson(view.angles->azimuth_rad)) : Json()},
                     {"off_nadir_deg", view.angles ? Json(DegreesJson(view.angles->off_nadir_rad)) : Json()},
                     {"has_image", !view.thumbnail.empty()}});
  }
  return {{"model", model.name},
          {"kind", ToText(model.kind)},
          {"length_m", OrNull(model.length_m, &MetresJson)},
          {"views", std::move(views)},
          {"sightings", std::move(sightings)}};
}

Json VideoToJson(const VideoRecord& video, const IndexLists& lists, const std::string& missing, bool has_copy,
                 bool with_searches) {
  const auto searches = std::ranges::equal_range(lists.searches, video.id, {}, &SearchRecord::video);
  const auto parts = std::ranges::equal_range(lists.search_parts, video.id, {}, &SearchPart::video);
  const VideoCoverage coverage = CoverageOf(video, lists.models, searches, parts);
  const auto objects = lists.objects_of_video.find(video.id);
  Json json = {{"id", video.id},
               {"name", ShownName(video)},
               {"width_px", video.width},
               {"height_px", video.height},
               {"frame_count", OrNull(video.frame_count)},
               {"duration_s", OrNull(video.duration_s, &TimeJson)},
               {"start_utc_us", OrNull(video.start_utc_us)},
               {"objects", objects == lists.objects_of_video.end() ? 0 : objects->second},
               {"missing", missing.empty() ? Json() : Json(missing)},
               {"has_copy", has_copy},
               {"is_searched", coverage.IsWhole()},
               {"searched", IntervalsToJson(coverage.searched)},
               {"searched_s", TimeJson(coverage.searched_s)},
               {"left_out", LeftOutToJson(coverage.left_out)}};
  if (with_searches) json["searches"] = SearchesToJson(video, searches, parts);
  return json;
}

Json ProjectToJson(const std::string& name, const IndexLists& lists, const ObjectCounts& counts, bool can_review,
                   bool has_views, bool has_jobs, const std::filesystem::path& categories, const BaseMap& base_map) {
  Json models = Json::array();
  for (const ModelRecord& model : lists.models) {
    const auto objects = lists.objects_of_model.find(model.id);
    models.push_back({{"id", model.id},
                      {"name", model.name},
                      {"kind", model.IsBoxed() ? "boxed" : ToText(model.kind)},
                      {"objects", objects == lists.objects_of_model.end() ? 0 : objects->second}});
  }
  Json bounds;
  if (lists.places) {
    bounds = {GeodeticJson(lists.places->west_rad), GeodeticJson(lists.places->south_rad),
              GeodeticJson(lists.places->east_rad), GeodeticJson(lists.places->north_rad)};
  }
  return {{"name", name},
          {"version", kVersion},
          {"can_review", can_review},
          {"has_views", has_views},
          {"has_jobs", has_jobs},
          {"categories", categories.empty() ? Json() : Json(categories.filename().string())},
          {"base_map", BaseMapToJson(base_map)},
          {"videos", lists.videos.size()},
          {"objects", counts.objects},
          {"accepted", counts.accepted},
          {"rejected", counts.rejected},
          {"unreviewed", counts.objects - counts.accepted - counts.rejected},
          {"models", std::move(models)},
          {"bounds", std::move(bounds)},
          {"index_version", lists.version},
          {"now_utc_us", NowUtcMicroseconds()}};
}

std::string JobTitle(const JobRecord& job) {
  const auto input = ParseJson(job.input_json);
  if (!input || !input->is_object()) return {};
  const auto text = [&](const char* name) {
    const auto found = input->find(name);
    return found != input->end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  if (job.kind == JobKind::kModel) return text("name");
  if (job.kind == JobKind::kSample) return "sample flight";
  if (job.kind == JobKind::kRemove && input->contains("model")) return text("model");
  if (job.kind == JobKind::kClip || job.kind == JobKind::kTrack || job.kind == JobKind::kLive) return text("title");
  return std::filesystem::path(text(job.kind == JobKind::kRefine ? "categories" : "video")).filename().string();
}

constexpr const char* kHiddenReason = "the source cannot be read: an administrator sees why";

namespace {

std::string ShownMessage(const std::string& message, SourceReasons reasons) {
  std::string shown = WithoutCredentials(message);
  return reasons == SourceReasons::kHidden ? WithoutFolders(shown) : shown;
}

}  // namespace

Json JobToJson(const JobRecord& job, std::int64_t now_us, SourceReasons reasons) {
  const JobProgress& progress = job.progress;
  // By the rate since this attempt began; the first seconds say little.
  Json left;
  if (job.state == WorkState::kRunning && job.started_utc_us && progress.total && progress.done > 0) {
    constexpr double kMinElapsed_s = 2;
    const double elapsed_s = 1e-6 * static_cast<double>(now_us - *job.started_utc_us);
    const auto rest = static_cast<double>(std::max<std::int64_t>(0, *progress.total - progress.done));
    if (elapsed_s >= kMinElapsed_s) left = std::round(elapsed_s * rest / static_cast<double>(progress.done));
  }
  // A source that is tried again has its reason while it runs or waits, too: with its address.
  const bool is_hidden = reasons == SourceReasons::kHidden && job.kind == JobKind::kLive &&
                         (job.state == WorkState::kFailed || progress.message.contains("://"));
  return {{"id", job.id},
          {"kind", ToText(job.kind)},
          {"title", JobTitle(job)},
          {"state", ToText(job.state)},
          {"done", progress.done},
          {"total", OrNull(progress.total)},
          {"unit", progress.unit},
          {"message", is_hidden ? kHiddenReason : ShownMessage(progress.message, reasons)},
          {"left_s", std::move(left)},
          {"behind_s", job.state == WorkState::kRunning ? OrNull(progress.behind_s, &TimeJson) : Json()},
          {"cancel_asked", job.cancel_asked},
          {"files", FilesOf(job)},
          {"video_id", VideoIdOf(job)},
          {"created_utc_us", job.created_utc_us},
          {"ended_utc_us", OrNull(job.ended_utc_us)}};
}

Json JobsToJson(const std::vector<JobRecord>& jobs, std::int64_t now_us, SourceReasons reasons) {
  Json rows = Json::array();
  for (const JobRecord& job : jobs) rows.push_back(JobToJson(job, now_us, reasons));
  return {{"jobs", std::move(rows)}};
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
  return {{"source", path.source ? Json(ToText(kCameraPathSourceTexts, *path.source)) : Json()},
          {"reason", path.reason.empty() ? Json() : Json(path.reason)},
          {"ground_m", OrNull(path.ground_m, &MetresJson)},
          {"points", std::move(points)}};
}

}  // namespace victorious
