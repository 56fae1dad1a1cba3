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

IndexBatch BatchOf(const BoxTrack& track, const VideoRecord& video, const ModelRecord& category) {
  const auto& seen = track.sightings;
  IndexBatch batch;
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
        {.tracklet_update = 0,
         .sighting = {.video = video.id,
                      .model = category.id,
                      .frame = one->frame,
                      .time_s = one->time_s,
                      .box = one->box,
                      .score = one->score,
                      .source = one->matches ? SightingSource::kRecognised : SightingSource::kTracked,
                      .observation = one->observation}});
  }
  return batch;
}

// Its tracklet in a video: the one that is there already, or a new one.
Expected<std::int64_t> PutTrack(const BoxTrack& track, const VideoRecord& video, const ModelRecord& category,
                                IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<std::int64_t> same, FindSameTrack(track, video, category, store));
  if (same) return *same;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> added, store.Commit(BatchOf(track, video, category)));
  return added.front();
}

// The object of these tracklets, and of all others of the objects that they belong to. Without a place, it keeps the
// one that an object has.
Expected<ObjectRecord> ObjectOf(const std::set<std::int64_t>& own, std::int64_t category,
                                const std::optional<Geolocation>& place, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> records, store.Tracklets());
  std::set<std::int64_t> objects;
  for (const TrackletRecord& one : records) {
    if (own.contains(one.id)) objects.insert(one.object);
  }
  ObjectRecord joined{.model = category, .place = place};
  for (const TrackletRecord& one : records) {
    if (objects.contains(one.object)) joined.tracklets.push_back(one.id);
  }
  if (joined.tracklets.empty()) {
    return Fail(ErrorCode::kConflict, "another process removed what was boxed: box it again");
  }
  joined.id = joined.tracklets.front();
  for (const std::int64_t object : objects) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> before, store.Objects({.object = object}));
    if (!joined.place && !before.empty()) joined.place = before.front().place;
  }
  return joined;
}

// Where it was seen last, in the last video that tells it.
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
  std::vector<std::set<std::int64_t>> tracklets(boxes.size());
  for (const BoxTrack& track : TracksOf(sightings)) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t tracklet,
                                PutTrack(track, videos[track.video], categories[track.box_index], store));
    tracklets[track.box_index].insert(tracklet);
  }
  std::vector<std::int64_t> objects;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    VICTORIOUS_CHECK(!tracklets[i].empty());
    VICTORIOUS_ASSIGN_OR_RETURN(const ObjectRecord object,
                                ObjectOf(tracklets[i], categories[i].id, LastPlace(sightings, i), store));
    VICTORIOUS_RETURN_IF_ERROR(store.PutObjects(std::span(&object, 1)));
    objects.push_back(object.id);
  }
  return objects;
}

}  // namespace victorious
