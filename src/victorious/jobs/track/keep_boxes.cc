#include "victorious/jobs/track/keep_boxes.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/jobs/index/index_run.h"

namespace victorious {
namespace {

// What is to be entered of one box in one video.
struct BoxTrack {
  std::size_t box_index = 0;
  std::size_t video = 0;
  std::vector<const BoxSighting*> sightings;
};

std::vector<BoxTrack> TracksOf(std::span<const BoxSighting> sightings) {
  std::map<std::pair<std::size_t, std::size_t>, BoxTrack> tracks;  // by box and video
  for (const BoxSighting& one : sightings) {
    BoxTrack& track = tracks[{one.box_index, one.video}];
    track.box_index = one.box_index;
    track.video = one.video;
    track.sightings.push_back(&one);
  }
  std::vector<BoxTrack> all;
  for (auto& [key, track] : tracks) all.push_back(std::move(track));
  return all;
}

Expected<ModelRecord> PutCategory(const std::string& name, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  const auto other = std::ranges::find(models, name, &ModelRecord::name);
  if (other != models.end() && !other->IsBoxed()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is the name of a {} that is searched for: give the box another type", name,
                            other->IsCategory() ? "category" : "model"));
  }
  return store.PutModel({.name = name, .content_id = std::string(kBoxedContentId), .kind = ModelKind::kCategory});
}

// The tracklet of a category in a video that follows the same thing: in half of the frames of the track or more, it has
// the same box.
Expected<std::optional<std::int64_t>> FindSameTrack(const BoxTrack& track, const VideoRecord& video,
                                                    const ModelRecord& category, IndexStore& store) {
  constexpr double kSameBox = 0.5;  // intersection over union
  std::map<std::int64_t, const BoxSighting*> by_frame;
  for (const BoxSighting* one : track.sightings) by_frame[one->frame] = one;
  std::map<std::int64_t, std::size_t> common;  // frames, by tracklet
  const auto count = [&](SightingRecord&& sighting) {
    const auto own = by_frame.find(sighting.frame);
    if (sighting.model != category.id || own == by_frame.end()) return true;
    if (IntersectionOverUnion(own->second->box, sighting.box) >= kSameBox) ++common[sighting.tracklet];
    return true;
  };
  VICTORIOUS_RETURN_IF_ERROR(
      store.VisitSightings({.category_name = category.name, .include_rejected = true, .video = video.id}, count));
  const auto most = std::ranges::max_element(common, {}, [](const auto& one) { return one.second; });
  if (most == common.end() || 2 * most->second < track.sightings.size()) return std::nullopt;
  return most->first;
}

void AppendTrack(const BoxTrack& track, const VideoRecord& video, const ModelRecord& category, IndexBatch& batch) {
  const auto& seen = track.sightings;
  const std::size_t update = batch.tracklets.size();
  batch.tracklets.push_back(
      {.id = std::nullopt,
       .tracklet = {.video = video.id,
                    .model = category.id,
                    .score = (*std::ranges::max_element(seen, {}, &BoxSighting::score))->score,
                    .frames = std::ssize(seen),
                    .first_time_s = (*std::ranges::min_element(seen, {}, &BoxSighting::time_s))->time_s,
                    .last_time_s = (*std::ranges::max_element(seen, {}, &BoxSighting::time_s))->time_s}});
  for (const BoxSighting* one : seen) {
    batch.sightings.push_back(
        {.tracklet_update = update,
         .sighting = {.video = video.id,
                      .model = category.id,
                      .frame = one->frame,
                      .time_s = one->time_s,
                      .box = one->box,
                      .score = one->score,
                      .source = one->matches ? SightingSource::kRecognised : SightingSource::kTracked,
                      .observation = one->observation}});
  }
}

// Adds the tracklets of the objects that these belong to.
Status AddTrackletsOfObjects(std::set<std::int64_t>& tracklets, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> records, store.Tracklets());
  std::set<std::int64_t> objects;
  for (const TrackletRecord& one : records) {
    if (tracklets.contains(one.id)) objects.insert(one.object);
  }
  for (const TrackletRecord& one : records) {
    if (objects.contains(one.object)) tracklets.insert(one.id);
  }
  return {};
}

// Where it was seen last, if its place is known.
std::optional<Geolocation> LastPlace(std::span<const BoxSighting> sightings, std::size_t box_index) {
  std::optional<Geolocation> place;
  for (const BoxSighting& one : sightings) {
    if (one.box_index == box_index && one.place) place = one.place;
  }
  return place;
}

}  // namespace

std::string CategoryOfBox(const UserBox& box) {
  return fmt::format("{}/{}", kBoxedContentId, box.type.empty() ? "object" : box.type);
}

Expected<std::vector<VideoRecord>> FindTrackedVideos(std::span<const std::string> videos, IndexStore& store,
                                                     const CancelToken& cancel) {
  std::vector<VideoRecord> records;
  for (const std::string& video : videos) {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, VideoReader::Open(video, {}));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string content_id, ContentIdOf(*reader, video, cancel));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoRecord> record, store.VideoOfContent(content_id));
    if (!record) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: is not in the index: add it first, with `victorious index`", video));
    }
    records.push_back(*record);
  }
  return records;
}

Expected<std::vector<std::int64_t>> KeepBoxes(std::span<const BoxSighting> sightings, std::span<const UserBox> boxes,
                                              std::span<const VideoRecord> videos, IndexStore& store) {
  std::vector<ModelRecord> categories;  // of the boxes
  for (const UserBox& box : boxes) {
    VICTORIOUS_ASSIGN_OR_RETURN(ModelRecord category, PutCategory(CategoryOfBox(box), store));
    categories.push_back(std::move(category));
  }
  IndexBatch batch;
  std::vector<std::size_t> box_of_added;
  std::vector<std::set<std::int64_t>> tracklets(boxes.size());
  for (const BoxTrack& track : TracksOf(sightings)) {
    const ModelRecord& category = categories[track.box_index];
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> same,
                                FindSameTrack(track, videos[track.video], category, store));
    if (same) {
      tracklets[track.box_index].insert(*same);
      continue;
    }
    AppendTrack(track, videos[track.video], category, batch);
    box_of_added.push_back(track.box_index);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> added, store.Commit(batch));
  for (std::size_t i = 0; i < added.size(); ++i) tracklets[box_of_added[i]].insert(added[i]);
  std::vector<ObjectRecord> objects;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    VICTORIOUS_CHECK(!tracklets[i].empty());
    VICTORIOUS_RETURN_IF_ERROR(AddTrackletsOfObjects(tracklets[i], store));
    objects.push_back({.id = *tracklets[i].begin(),
                       .model = categories[i].id,
                       .tracklets = {tracklets[i].begin(), tracklets[i].end()},
                       .place = LastPlace(sightings, i)});
  }
  VICTORIOUS_RETURN_IF_ERROR(store.PutObjects(objects));
  std::vector<std::int64_t> ids;
  for (const ObjectRecord& object : objects) ids.push_back(object.id);
  return ids;
}

}  // namespace victorious
