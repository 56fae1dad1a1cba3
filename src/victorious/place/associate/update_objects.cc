#include "victorious/place/associate/update_objects.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/json.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/place/associate/associate_objects.h"
#include "victorious/place/associate/flight_errors.h"
#include "victorious/place/associate/kept_fits.h"
#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/observed_tracklet.h"
#include "victorious/place/associate/search_counts.h"
#include "victorious/types/searched_frames.h"

namespace victorious {
namespace {

// The member of an object; null if there is none.
nlohmann::json Member(const nlohmann::json& object, const char* name) {
  return object.is_object() ? object.value(name, nlohmann::json()) : nlohmann::json();
}

// A number of frames; 0 if it is none.
std::int64_t Interval(const nlohmann::json& value) {
  constexpr std::int64_t kMaxFrames = 1'000'000;
  return value.is_number_integer() ? std::clamp<std::int64_t>(value.get<std::int64_t>(), 0, kMaxFrames) : 0;
}

// By the fields "every" and "follow" of the search's options. Error: kDataLoss if there is no "every".
Expected<SearchedFrames> ReadSearchedFrames(const SearchRecord& search, const std::string& video,
                                            const std::string& model) {
  const nlohmann::json options = ParseStrictJson(search.options_json).value_or(nullptr);
  const nlohmann::json follow = Member(options, "follow");
  SearchedFrames frames{.every = Interval(Member(options, "every"))};
  if (frames.every == 0) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the stored options of the search for {} have no whole number \"every\" of at least 1",
                            video, model));
  }
  if (Member(follow, "enabled") == true) frames.restart = Interval(Member(follow, "restart_interval_frames"));
  return frames;
}

// The frames of a search, by the texts of the options, which are few.
class StoredSearches {
 public:
  Expected<SearchedFrames> Of(const SearchRecord& search, const std::string& video, const std::string& model) {
    const auto known = of_options_.find(search.options_json);
    if (known != of_options_.end()) return known->second;
    VICTORIOUS_ASSIGN_OR_RETURN(const SearchedFrames frames, ReadSearchedFrames(search, video, model));
    return of_options_[search.options_json] = frames;
  }

 private:
  std::map<std::string, SearchedFrames> of_options_;
};

// The full-frame searches for models; categories do not count.
Expected<SearchCounts> CountFullFrameSearches(const std::vector<ModelRecord>& models,
                                              const std::vector<VideoRecord>& videos, IndexStore& store) {
  std::map<std::int64_t, std::string> names_of_models;
  for (const ModelRecord& model : models) {
    if (!model.IsCategory()) names_of_models[model.id] = model.name;
  }
  std::map<std::int64_t, const VideoRecord*> videos_by_id;
  for (const VideoRecord& video : videos) videos_by_id[video.id] = &video;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchRecord> searches, store.Searches());
  StoredSearches stored;
  SearchCounts counts;
  for (const SearchRecord& search : searches) {
    const auto video = videos_by_id.find(search.video);
    const auto model = names_of_models.find(search.model);
    if (video == videos_by_id.end() || model == names_of_models.end()) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const SearchedFrames frames, stored.Of(search, video->second->name, model->second));
    counts.Add(search.video, frames.CountBefore(search.next_frame), video->second->duration_s);
  }
  return counts;
}

// True if the telemetry is a table of camera states: given, or beside the video. No column says so.
bool IsTable(const VideoRecord& video) {
  if (!video.telemetry.empty()) return video.telemetry.ends_with(".csv");
  const auto beside = FindTelemetryFile((std::filesystem::path(video.folder) / video.name).string());
  return beside && beside->extension() == ".csv";
}

// Tracklets without content, by id, of each video; but for those of what people boxed, whose objects are what they
// boxed.
std::map<std::int64_t, std::vector<ObservedTracklet>> ObservedOf(const std::vector<TrackletRecord>& records,
                                                                 const std::vector<ModelRecord>& models,
                                                                 const std::vector<VideoRecord>& videos) {
  std::set<std::int64_t> categories;
  std::set<std::int64_t> cad_models;
  std::set<std::int64_t> boxed;  // models
  for (const ModelRecord& model : models) {
    if (model.IsBoxed()) boxed.insert(model.id);
    if (model.IsCategory()) categories.insert(model.id);
    if (model.kind == ModelKind::kCad) cad_models.insert(model.id);
  }
  std::map<std::int64_t, const VideoRecord*> videos_by_id;
  std::set<std::int64_t> with_tables;  // videos
  for (const VideoRecord& video : videos) {
    videos_by_id[video.id] = &video;
    if (IsTable(video)) with_tables.insert(video.id);
  }
  std::map<std::int64_t, std::vector<ObservedTracklet>> flights;
  for (const TrackletRecord& record : records) {
    if (boxed.contains(record.model)) continue;
    const auto video = videos_by_id.find(record.video);
    const bool is_known = video != videos_by_id.end();
    flights[record.video].push_back({.record = record,
                                     .is_category = categories.contains(record.model),
                                     .is_cad_model = cad_models.contains(record.model),
                                     .is_of_photos = is_known && video->second->is_of_photos,
                                     .has_filtered_telemetry = !with_tables.contains(record.video),
                                     .start_utc_us = is_known ? video->second->start_utc_us : std::nullopt,
                                     .frames = {},
                                     .boxes = {},
                                     .scores = {},
                                     .views = {},
                                     .observations = {},
                                     .observation_frames = {},
                                     .summary = {}});
  }
  return flights;
}

using TellOfVideo = std::function<void(const VideoRecord&, const FlightNotes&)>;

Expected<ObjectUpdate> MakeObjects(const ObjectOptions& options, IndexStore& store, const KeptFits::Interim& interim,
                                   const TellOfVideo& tell) {
  // Revisions are read before the sightings that they stand for: a later change gives them another key. So are
  // tracklets before their models: one that another process adds now is not taken for what it is not.
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> records, store.Tracklets());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  auto flights = ObservedOf(records, models, videos);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto fits, KeptFits::Load(options, store, interim));
  std::vector<const ObservedTracklet*> tracklets;
  for (auto& [video, of_one] : flights) {
    VICTORIOUS_RETURN_IF_ERROR(fits->AddFlight(of_one));
    for (const ObservedTracklet& tracklet : of_one) tracklets.push_back(&tracklet);
  }
  std::ranges::sort(tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  std::map<std::int64_t, std::string> names;
  for (const ModelRecord& model : models) names[model.id] = model.name;
  for (const VideoRecord& video : videos) {
    const auto found = fits->errors().find(video.id);
    if (found == fits->errors().end()) continue;
    const bool has_lines = std::ranges::any_of(
        flights[video.id], [](const ObservedTracklet& tracklet) { return tracklet.summary.observations > 0; });
    FlightNotes notes{.warnings = Describe(found->second, names), .telemetry_errors = {}};
    if (has_lines) notes.telemetry_errors = DescribeErrors(found->second.telemetry, options);
    tell(video, notes);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const SearchCounts searches, CountFullFrameSearches(models, videos, store));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletLink> links, store.TrackletLinks());
  ObjectUpdate update{.objects = {}, .put_fits = {}, .deleted_fits = {}, .options_json = options.kept_json};
  update.objects = AssociateTracklets(tracklets, fits->overlaps(), searches, LinkConstraints(links), *fits);
  VICTORIOUS_RETURN_IF_ERROR(fits->status());
  fits->AddChanges(update);
  return update;
}

}  // namespace

Status UpdateObjects(const ObjectOptions& options, IndexStore& store, const CancelToken& cancel,
                     const TellOfVideo& tell, std::chrono::milliseconds interval) {
  std::vector<std::pair<VideoRecord, FlightNotes>> noted;
  const auto make = [&] {
    noted.clear();
    const auto keep = [&](const VideoRecord& video, const FlightNotes& notes) { noted.emplace_back(video, notes); };
    return MakeObjects(options, store, {.interval = interval, .cancel = cancel}, keep);
  };
  VICTORIOUS_RETURN_IF_ERROR(store.UpdateObjects(make, cancel));
  for (const auto& [video, notes] : noted) tell(video, notes);
  return {};
}

}  // namespace victorious
