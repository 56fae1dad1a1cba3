#include "victorious/store/sql/filter_conditions.h"

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/store/sql/place_conditions.h"
#include "victorious/store/sql/records.h"

namespace victorious::sql {
namespace {

Status AddVideos(IndexStore& store, const SightingFilter& filter, std::string_view column, Conditions& conditions) {
  if (filter.video) conditions.AddOneOf(column, {*filter.video});
  if (!filter.video_name) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  std::vector<std::int64_t> ids;
  for (const VideoRecord& video : FindVideosByName(videos, *filter.video_name)) ids.push_back(video.id);
  conditions.AddOneOf(column, ids);
  return {};
}

// True of a rejected object; one of which only the place is rejected is listed. Takes kPlaceReason twice.
constexpr std::string_view kIsRejected =
    "(coalesce(o.rejection_reason, '') <> '' AND substr(o.rejection_reason, 1, length(?)) <> ?)";

void AddRejected(const SightingFilter& filter, Conditions& conditions) {
  if (filter.include_rejected) return;
  const std::string reason(kPlaceReason);
  conditions.Add(fmt::format("NOT {}", kIsRejected), reason, reason);
}

// Of objects that nobody has decided.
void AddThresholds(const SightingFilter& filter, Conditions& conditions) {
  if (filter.thresholds == ThresholdUse::kIgnored) return;
  conditions.Add(
      "(o.verdict IS NOT NULL OR o.order_score <= -coalesce((SELECT h.min_score FROM thresholds h JOIN models m ON "
      "m.name = h.model_name WHERE m.id = o.model_id), 0))");
}

void AddWeak(const SightingFilter& filter, Conditions& conditions) {
  if (!filter.without_weak) return;
  const std::string reason(kPlaceReason);
  conditions.Add(
      fmt::format("(o.verdict IS NOT NULL OR o.object_score IS NULL OR o.object_score >= ? OR {})", kIsRejected),
      kWeakScore, reason, reason);
}

void AddModel(const SightingFilter& filter, std::string_view column, Conditions& conditions) {
  const std::string category(ToText(ModelKind::kCategory));
  if (filter.model_name) {
    conditions.Add(fmt::format("{} = (SELECT id FROM models WHERE name = ? AND kind <> ?)", column), *filter.model_name,
                   category);
  }
  if (filter.category_name) {
    conditions.Add(fmt::format("{} IN (SELECT id FROM models, (SELECT ? AS prefix) AS wanted "
                               "WHERE kind = ? AND substr(name || '/', 1, length(prefix)) = prefix)",
                               column),
                   *filter.category_name + "/", category);
  }
}

void AddTimes(const SightingFilter& filter, std::string_view first, std::string_view last, Conditions& conditions) {
  if (filter.from_s) conditions.Add(fmt::format("{} >= ?", last), *filter.from_s);
  if (filter.to_s) conditions.Add(fmt::format("{} <= ?", first), *filter.to_s);
}

}  // namespace

Expected<Conditions> ObjectConditions(IndexStore& store, const SightingFilter& filter, Dialect dialect) {
  Conditions tracklet_conditions;
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(store, filter, "video_id", tracklet_conditions));
  if (filter.tracklet) tracklet_conditions.AddOneOf("id", {*filter.tracklet});
  AddTimes(filter, "first_time_s", "last_time_s", tracklet_conditions);
  Conditions conditions;
  AddModel(filter, "o.model_id", conditions);
  AddRejected(filter, conditions);
  AddThresholds(filter, conditions);
  AddWeak(filter, conditions);
  if (filter.near) AddNear(dialect, *filter.near, PlacedObjects::kAll, conditions);
  conditions.AddQuery("o.id IN (SELECT object_id FROM tracklets {})", tracklet_conditions);
  if (filter.object) conditions.AddOneOf("o.id", {*filter.object});
  return conditions;
}

Expected<Conditions> SightingConditions(IndexStore& store, const SightingFilter& filter, Dialect dialect) {
  Conditions conditions;
  // By video and tracklet, SQLite would read all sightings of the video, to save the sort. The "+" excludes the video
  // from the choice of the index, which leaves that of tracklets.
  const bool reads_by_tracklet = dialect == Dialect::kSqlite && filter.tracklet.has_value();
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(store, filter, reads_by_tracklet ? "+s.video_id" : "s.video_id", conditions));
  AddModel(filter, "t.model_id", conditions);
  if (filter.object) conditions.AddOneOf("t.object_id", {*filter.object});
  if (filter.tracklet) conditions.AddOneOf("s.tracklet_id", {*filter.tracklet});
  AddTimes(filter, "s.time_s", "s.time_s", conditions);
  AddRejected(filter, conditions);
  AddThresholds(filter, conditions);
  AddWeak(filter, conditions);
  if (filter.near) AddNear(dialect, *filter.near, PlacedObjects::kAll, conditions);
  // PostgreSQL has the sightings in parts by video: only those of the tracklets' videos are looked into.
  if (dialect == Dialect::kPostgres && (filter.object || filter.tracklet)) conditions.Add("s.video_id = t.video_id");
  return conditions;
}

Expected<Conditions> KeptFrameConditions(IndexStore& store, const SightingFilter& filter) {
  Conditions conditions;
  VICTORIOUS_RETURN_IF_ERROR(AddVideos(store, filter, "video_id", conditions));
  AddTimes(filter, "time_s", "time_s", conditions);
  return conditions;
}

}  // namespace victorious::sql
