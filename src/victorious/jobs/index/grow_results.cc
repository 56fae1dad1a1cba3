#include "victorious/jobs/index/grow_results.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <ranges>
#include <utility>
#include <vector>

#include "victorious/base/stage_time.h"
#include "victorious/jobs/index/track_growth.h"
#include "victorious/jobs/reverse_frame_reader.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/tracklet_linker.h"
#include "victorious/place/observe/bearing_observation.h"
#include "victorious/place/observe/object_pose.h"

namespace victorious {
namespace {

constexpr int kGrowMemory_mb = 256;  // of frames

// Places of one model's tracklets, by their own sightings.
class GrowthPlaces {
 public:
  GrowthPlaces(const IndexPass& pass, std::span<const double> times_s, std::span<const SightingRecord> sightings)
      : pass_(pass), times_s_(times_s), objects_(pass.options.objects) {
    objects_.ground.reset();  // as for linking: places of one flight are compared
    std::map<std::int64_t, std::vector<BearingObservation>> of_tracklets;
    for (const SightingRecord& one : sightings) {
      if (one.observation) of_tracklets[one.tracklet].push_back(*one.observation);
    }
    for (const auto& [tracklet, observations] : of_tracklets)
      places_[tracklet] = EstimatePlace(observations, objects_, kFlightErrorFraction).place;
  }

  [[nodiscard]] std::optional<BearingObservation> Observe(std::int64_t frame, const Box& box) const {
    const double time_s = times_s_[static_cast<std::size_t>(frame)];
    const CameraState camera = pass_.cameras.At(time_s).value_or(CameraState{});
    const auto pose =
        EstimateBoxDirection(box, {pass_.video.width, pass_.video.height}, camera, kCategoryCentreFraction);
    return pose ? MakeBearingObservation(*pose, camera) : std::nullopt;
  }

  [[nodiscard]] bool IsPlausible(std::int64_t tracklet, std::int64_t frame, const Box& box) const {
    const auto place = places_.find(tracklet);
    if (place == places_.end() || !place->second) return true;
    const std::optional<BearingObservation> observation = Observe(frame, box);
    if (!observation) return true;
    const double time_s = times_s_[static_cast<std::size_t>(frame)];
    return MahalanobisDistance(*observation, PredictPlace(*place->second, time_s), kMergeSlack_m, objects_.locate, 1) <=
           kTrackletGateSigma;
  }

 private:
  const IndexPass& pass_;
  std::span<const double> times_s_;
  ObjectOptions objects_;
  std::map<std::int64_t, std::optional<Geolocation>> places_;
};

// One model's part of the batch.
void AppendGrowth(const IndexPass& pass, const SearchRecord& search, std::span<const double> times_s,
                  std::span<const TrackletRecord> tracklets, const GrowthPlaces& places, TrackGrowth growth,
                  IndexBatch& batch) {
  std::map<std::int64_t, TrackletRecord> records;
  for (const TrackletRecord& tracklet : tracklets) records[tracklet.id] = tracklet;
  for (const auto& [into, from] : growth.joined) {
    batch.joined.push_back({.into = into, .from = from});
    TrackletRecord& record = records.at(into);
    const TrackletRecord& other = records.at(from);
    record.score = std::max(record.score, other.score);
    record.frames += other.frames;
    record.first_time_s = std::min(record.first_time_s, other.first_time_s);
    record.last_time_s = std::max(record.last_time_s, other.last_time_s);
  }
  std::map<std::int64_t, std::size_t> updates;  // by tracklet
  for (GrownSighting& grown : growth.sightings) {
    const double time_s = times_s[static_cast<std::size_t>(grown.frame)];
    TrackletRecord& record = records.at(grown.tracklet);
    record.frames += 1;
    record.first_time_s = std::min(record.first_time_s, time_s);
    record.last_time_s = std::max(record.last_time_s, time_s);
    const auto [update, is_new] = updates.try_emplace(grown.tracklet, batch.tracklets.size());
    if (is_new) batch.tracklets.push_back({.id = grown.tracklet, .tracklet = {}});
    batch.tracklets[update->second].tracklet = record;
    batch.sightings.push_back({.tracklet_update = update->second,
                               .sighting = {.video = pass.video.id,
                                            .model = search.model,
                                            .frame = grown.frame,
                                            .time_s = time_s,
                                            .box = grown.box,
                                            .outline = std::move(grown.outline),
                                            .score = grown.score,
                                            .source = SightingSource::kTracked,
                                            .matches = 0,  // with the model: its views were learnt
                                            .observation = places.Observe(grown.frame, grown.box)}});
  }
}

}  // namespace

bool MayGrow(const IndexPass& pass, bool is_live) {
  const auto is_of_photos = [](const ObjectModel& model) { return model.kind == ModelKind::kPhotos; };
  return pass.options.grow.enabled && IsTrackingEnabled(pass) && !is_live && !pass.job.frame_budget &&
         !pass.job.from_s && pass.segment == nullptr && !pass.cameras.is_of_photos() &&
         std::ranges::any_of(pass.recognizer.models(), is_of_photos);
}

Status GrowResults(const IndexPass& pass, std::span<const double> times_s, std::int64_t end, const CancelToken& cancel,
                   IndexStore& store, IndexBatch& batch) {
  const StageScope scope(Stage::kTracking);
  // What one model found.
  struct Found {
    std::size_t model = 0;  // of the recogniser
    std::vector<TrackletRecord> tracklets;
    std::vector<SightingRecord> sightings;
    GrowthPlaces places;
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> all, store.Tracklets());
  const std::vector<ObjectModel>& models = pass.recognizer.models();
  std::vector<Found> found;
  for (std::size_t m = 0; m < models.size(); ++m) {
    if (models[m].kind != ModelKind::kPhotos) continue;
    std::vector<TrackletRecord> tracklets;
    std::ranges::copy_if(all, std::back_inserter(tracklets), [&](const TrackletRecord& one) {
      return one.video == pass.video.id && one.model == pass.searches[m].model;
    });
    if (tracklets.empty()) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::vector<SightingRecord> sightings,
        store.Sightings({.model_name = models[m].name, .include_rejected = true, .video = pass.video.id}));
    GrowthPlaces places(pass, times_s, sightings);
    found.push_back({m, std::move(tracklets), std::move(sightings), std::move(places)});
  }
  std::vector<GrowthInput> inputs;
  for (const Found& one : found) {
    inputs.push_back({.model = models[one.model],
                      .tracklets = one.tracklets,
                      .sightings = one.sightings,
                      .extractor = pass.extractor,
                      .recognize = pass.options.recognize,
                      .options = pass.options.grow,
                      .is_plausible = [&](std::int64_t tracklet, std::int64_t frame, const Box& box) {
                        return one.places.IsPlausible(tracklet, frame, box);
                      }});
  }
  const std::int64_t frame_bytes = std::max<std::int64_t>(1, std::int64_t{3} * pass.video.width * pass.video.height);
  const ReverseFrameReader reader(pass.job.video, times_s, kGrowMemory_mb, cancel);
  const GrowthVideo video{.times_s = times_s,
                          .end = std::min<std::int64_t>(end, std::ssize(times_s)),
                          .frame = FrameBox(pass.video.width, pass.video.height),
                          .read = std::bind_front(&ReverseFrameReader::ReadInterval, &reader),
                          .max_wanted = std::max<std::int64_t>(4, (std::int64_t{kGrowMemory_mb} << 20) / frame_bytes)};
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackGrowth> growths, GrowTracks(video, inputs, cancel));
  for (std::size_t i = 0; i < found.size(); ++i) {
    AppendGrowth(pass, pass.searches[found[i].model], times_s, found[i].tracklets, found[i].places,
                 std::move(growths[i]), batch);
  }
  return {};
}

}  // namespace victorious
