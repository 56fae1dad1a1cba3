#include "victorious/jobs/regroup_objects.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "victorious/jobs/association_options.h"
#include "victorious/place/associate/update_objects.h"

namespace victorious {
namespace {

using TrackletsById = std::map<std::int64_t, TrackletRecord>;

Expected<TrackletsById> ReadTracklets(IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> records, store.Tracklets());
  TrackletsById by_id;
  for (const TrackletRecord& record : records) by_id.emplace_hint(by_id.end(), record.id, record);
  return by_id;
}

Status CheckNumbers(const TrackletGroups& groups) {
  std::set<std::int64_t> named;
  for (const std::vector<std::int64_t>& group : groups.groups) {
    if (group.empty()) return Fail(ErrorCode::kInvalidArgument, "a group has no moment: give at least one");
    for (const std::int64_t tracklet : group) {
      if (!named.insert(tracklet).second)
        return Fail(ErrorCode::kInvalidArgument, fmt::format("moment {} is named twice", tracklet));
    }
  }
  if (named.size() >= 2) return {};
  return Fail(ErrorCode::kInvalidArgument, "fewer than two moments: there is nothing to join or to split");
}

// They are there, of one model, and made by a search.
Status CheckModel(const TrackletGroups& groups, const TrackletsById& tracklets, IndexStore& store) {
  std::optional<std::int64_t> common;
  for (const std::vector<std::int64_t>& group : groups.groups) {
    for (const std::int64_t id : group) {
      const auto found = tracklets.find(id);
      if (found == tracklets.end()) {
        return Fail(ErrorCode::kNotFound,
                    fmt::format("moment {} is not in the index any more (a new search may have replaced it)", id));
      }
      if (common && *common != found->second.model) {
        return Fail(ErrorCode::kInvalidArgument,
                    "the moments are of different models or categories: only those of one can be one object");
      }
      common = found->second.model;
    }
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  const auto model = std::ranges::find(models, *common, &ModelRecord::id);
  if (model == models.end() || !model->IsBoxed()) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "what was boxed and followed stays the object of its box: only what a search found is joined and split");
}

// Nothing stands in a frame twice.
Status CheckFrames(const std::vector<std::int64_t>& group, IndexStore& store) {
  std::set<std::pair<std::int64_t, std::int64_t>> frames;  // of videos
  std::optional<SightingRecord> second;
  for (const std::int64_t tracklet : group) {
    const SightingFilter filter{.include_rejected = true, .tracklet = tracklet};
    VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings(filter, [&](SightingRecord&& sighting) {
      if (!frames.emplace(sighting.video, sighting.frame).second) second = std::move(sighting);
      return !second;
    }));
    if (second) break;
  }
  if (!second) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  const auto video = std::ranges::find(videos, second->video, &VideoRecord::id);
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} shows both at {:.2f} s: they are two objects",
                          video == videos.end() ? std::string("a video") : ShownName(*video), second->time_s));
}

Status MakeObjectsAnew(const ObjectOptions& options, IndexStore& store, const CancelToken& cancel) {
  Status made = UpdateObjects(options, store, cancel, [](const VideoRecord&, const FlightNotes&) {});
  if (!made)
    made.error().message = "the correction is kept, the objects follow with the next search: " + made.error().message;
  return made;
}

// Of the first tracklet of each group.
Expected<std::vector<std::int64_t>> ObjectsOf(const TrackletGroups& groups, const TrackletsById& tracklets) {
  std::vector<std::int64_t> objects;
  for (const std::vector<std::int64_t>& group : groups.groups) {
    const auto found = group.empty() ? tracklets.end() : tracklets.find(group.front());
    if (found == tracklets.end())
      return Fail(ErrorCode::kNotFound, "a search has replaced the moments meanwhile: look at them again");
    objects.push_back(found->second.object);
  }
  return objects;
}

// Whether each group is one object, and each another one.
bool AreAsSaid(const TrackletGroups& groups, const std::vector<std::int64_t>& objects, const TrackletsById& tracklets) {
  if (std::set(objects.begin(), objects.end()).size() != objects.size()) return false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto is_of_it = [&](std::int64_t id) {
      const auto found = tracklets.find(id);
      return found != tracklets.end() && found->second.object == objects[i];
    };
    if (!std::ranges::all_of(groups.groups[i], is_of_it)) return false;
  }
  return true;
}

}  // namespace

Expected<RegroupedObjects> RegroupObjects(const TrackletGroups& groups, IndexStore& store, const CancelToken& cancel,
                                          const WarningSink& warn) {
  VICTORIOUS_RETURN_IF_ERROR(CheckNumbers(groups));
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackletsById before, ReadTracklets(store));
  VICTORIOUS_RETURN_IF_ERROR(CheckModel(groups, before, store));
  for (const std::vector<std::int64_t>& group : groups.groups) VICTORIOUS_RETURN_IF_ERROR(CheckFrames(group, store));
  // Before anything is kept: a terrain that cannot be read any more.
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectOptions options, ReadAssociation(store, warn));
  RegroupedObjects regrouped;
  VICTORIOUS_ASSIGN_OR_RETURN(regrouped.correction, store.PutTrackletGroups(groups));
  VICTORIOUS_RETURN_IF_ERROR(MakeObjectsAnew(options, store, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackletsById after, ReadTracklets(store));
  VICTORIOUS_ASSIGN_OR_RETURN(regrouped.objects, ObjectsOf(groups, after));
  if (AreAsSaid(groups, regrouped.objects, after)) return regrouped;
  VICTORIOUS_RETURN_IF_ERROR(store.DeleteTrackletGroups(regrouped.correction, groups.author, groups.made_utc_us));
  VICTORIOUS_RETURN_IF_ERROR(MakeObjectsAnew(options, store, cancel));
  return Fail(ErrorCode::kInvalidArgument,
              "the moments cannot be grouped so: other moments of their objects share frames: name these, too");
}

Expected<std::vector<std::int64_t>> UndoRegrouping(std::int64_t correction, const TrackletGroups& groups,
                                                   IndexStore& store, const CancelToken& cancel,
                                                   const WarningSink& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(const ObjectOptions options, ReadAssociation(store, warn));
  VICTORIOUS_RETURN_IF_ERROR(store.DeleteTrackletGroups(correction, groups.author, groups.made_utc_us));
  VICTORIOUS_RETURN_IF_ERROR(MakeObjectsAnew(options, store, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const TrackletsById after, ReadTracklets(store));
  return ObjectsOf(groups, after);
}

}  // namespace victorious
