// Data association of an index that grows: towns, over each of which several videos flew, and one video more. The other
// towns are none of its business; what it costs nevertheless is what every run reads.
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/benchmarks.h"
#include "testing/data.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/place/associate/update_objects.h"
#include "victorious/store/index_store.h"

namespace victorious::bench {
namespace {

constexpr int kModels = 20;
constexpr int kObjectsOfTown = 24;
constexpr int kObjectsOfVideo = 20;  // on average
constexpr int kFrames = 3000;        // of a video
constexpr double kFrameRate = 10;

struct Archive {
  int videos = 0;
  int videos_of_town = 10;
  int sightings = 50;     // of an object in a video
  int observed_each = 1;  // every so many of them has a line of sight, but for the video more: the first fits are cheap
};

struct Object {
  std::size_t model = 0;
  Eigen::Vector3d place_enu;
  Eigen::Vector3d velocity_enu;
};

// One in ten drives.
std::vector<Object> MakeTown(int town) {
  Random random(static_cast<std::uint64_t>(town) + 1);
  std::vector<Object> objects;
  for (int i = 0; i < kObjectsOfTown; ++i) {
    const bool drives = i % 10 == 0;
    objects.push_back({.model = random.Below(kModels),
                       .place_enu = {random.Uniform(-200, 200), random.Uniform(-200, 200), 1},
                       .velocity_enu = drives ? Eigen::Vector3d(random.Uniform(2, 8), random.Uniform(2, 8), 0)
                                              : Eigen::Vector3d(0, 0, 0)});
  }
  return objects;
}

// By a camera that circles the town: 400 m away, 150 m high, 20 m/s.
BearingObservation Observe(const Object& object, const TangentPlane& town, double time_s, Random& random) {
  const Eigen::Vector3d camera(400 * std::cos(0.05 * time_s), 400 * std::sin(0.05 * time_s), 150);
  const Eigen::Vector3d line = object.place_enu + time_s * object.velocity_enu - camera;
  BearingObservation observation;
  observation.line = {.time_s = time_s,
                      .camera = town.GeodeticFromEnu(camera),
                      .azimuth_rad = std::atan2(line.x(), line.y()) + 1e-3 * random.Normal(),
                      .elevation_rad = std::asin(line.z() / line.norm()) + 1e-3 * random.Normal(),
                      .range_m = line.norm() * (1 + 0.02 * random.Normal()),
                      .sigma_rad = 1e-3};
  observation.line.sigma_range_m = 0.02 * *observation.line.range_m;
  return observation;
}

Status AddVideo(int number, int town, int sightings, int observed_each, const std::vector<std::int64_t>& models,
                IndexStore& store) {
  const std::string name = fmt::format("/videos/{:05}.mp4", number);
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoRecord video,
                              store.PutVideo({.content_id = name, .name = name, .width = 1920, .height = 1080}));
  // Towns lie 11 km apart, so that no object of one is near another's.
  const TangentPlane plane(
      {RadiansFromDegrees(45 + 0.1 * (town % 50)), RadiansFromDegrees(5 + 0.15 * (town / 50)), 300});
  Random random(1'000'000 + static_cast<std::uint64_t>(number));
  IndexBatch batch;
  for (const Object& object : MakeTown(town)) {
    if (random.Uniform() > static_cast<double>(kObjectsOfVideo) / kObjectsOfTown) continue;
    const auto first = static_cast<std::int64_t>(random.Below(kFrames - sightings));
    batch.tracklets.push_back({std::nullopt,
                               {.video = video.id,
                                .model = models[object.model],
                                .score = 0.95,
                                .frames = sightings,
                                .first_time_s = static_cast<double>(first) / kFrameRate,
                                .last_time_s = static_cast<double>(first + sightings - 1) / kFrameRate}});
    for (std::int64_t frame = first; frame < first + sightings; ++frame) {
      const double time_s = static_cast<double>(frame) / kFrameRate;
      SightingRecord sighting{.frame = frame,
                              .time_s = time_s,
                              .box = {1000 + 4 * object.place_enu.x(), 500 + 2 * object.place_enu.y(), 60, 40},
                              .outline = {{0, 0}, {60, 0}, {60, 40}, {0, 40}},
                              .score = 0.95,
                              .matches = 20};
      if ((frame - first) % observed_each == 0) sighting.observation = Observe(object, plane, time_s, random);
      batch.sightings.push_back({batch.tracklets.size() - 1, std::move(sighting)});
    }
  }
  for (const std::int64_t model : models) {
    batch.progress.push_back({{.video = video.id,
                               .model = model,
                               .next_frame = kFrames,
                               .finished = true,
                               .options_json = R"({"every": 1})",
                               .program_version = "0"},
                              0});
  }
  const auto committed = store.Commit(batch);
  if (!committed) return std::unexpected(committed.error());
  return {};
}

Expected<double> TimeUpdate(IndexStore& store) {
  const auto start = std::chrono::steady_clock::now();
  VICTORIOUS_RETURN_IF_ERROR(
      UpdateObjects(ObjectOptions(), store, CancelToken(), [](const VideoRecord&, const FlightNotes&) {}));
  return MillisecondsSince(start);
}

Expected<Result> TimeIndexOf(const Archive& archive) {
  const testing::ScratchFolder folder;
  VICTORIOUS_ASSIGN_OR_RETURN(const auto store, OpenSqliteStore(folder.path() / "index.db", StoreMode::kCreate));
  std::vector<std::int64_t> models;
  for (int i = 0; i < kModels; ++i) {
    const std::string name = fmt::format("model-{:02}", i);
    VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord model,
                                store->PutModel({.name = name, .content_id = name, .kind = ModelKind::kCad}));
    models.push_back(model.id);
  }
  const auto add = [&](int video, int town, int observed_each) {
    return AddVideo(video, town, archive.sightings, observed_each, models, *store);
  };
  for (int video = 0; video < archive.videos; ++video)
    VICTORIOUS_RETURN_IF_ERROR(add(video, video / archive.videos_of_town, archive.observed_each));
  VICTORIOUS_ASSIGN_OR_RETURN(const double anew_ms, TimeUpdate(*store));
  VICTORIOUS_ASSIGN_OR_RETURN(const double unchanged_ms, TimeUpdate(*store));
  // Over the first town.
  VICTORIOUS_RETURN_IF_ERROR(add(archive.videos, 0, 1));
  VICTORIOUS_ASSIGN_OR_RETURN(const double one_more_ms, TimeUpdate(*store));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> tracklets, store->Tracklets());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store->Objects({.include_rejected = true}));
  const auto count = static_cast<double>(tracklets.size());
  return Result{.name = fmt::format("associate_{}", archive.videos),
                .median_ms = one_more_ms,
                .peer_median_ms = {{"anew", anew_ms}},
                .figures = {{"unchanged_ms", unchanged_ms},
                            {"objects", static_cast<double>(objects.size())},
                            {"tracklets", count},
                            {"sightings", count * archive.sightings}}};
}

}  // namespace

Expected<std::vector<Result>> BenchAssociate(const Settings& settings) {
  std::vector<Archive> archives = {{.videos = 10}, {.videos = 40}, {.videos = 160}};
  if (settings.quick) archives = {{.videos = 2}};
  if (settings.large) archives = {{.videos = 2500, .videos_of_town = 1, .sightings = 100, .observed_each = 10}};
  std::vector<Result> results;
  for (const Archive& archive : archives) {
    VICTORIOUS_ASSIGN_OR_RETURN(results.emplace_back(), TimeIndexOf(archive));
  }
  return results;
}

}  // namespace victorious::bench
