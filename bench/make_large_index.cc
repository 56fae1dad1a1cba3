// make-large-index FILE|URL [VIDEOS [OBJECTS_PER_VIDEO [SIGHTINGS_PER_OBJECT]]]: writes an index of drawn rows, with
// which bench/page_scale.mjs measures the page. Default: 1000 videos, 50,000 objects, 5,000,000 sightings of 20 models
// in about a gigabyte. The videos do not exist. The same rows at each run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

struct Sizes {
  int videos = 1000;
  int objects = 50;     // of a video
  int sightings = 100;  // of an object
};

Status Fill(IndexStore& store, const Sizes& sizes) {
  constexpr int kModels = 20;
  constexpr int kShownBoxes = 64;
  constexpr double kFrameRate = 10;
  Random random(20);
  std::vector<std::int64_t> models;
  for (int i = 0; i < kModels; ++i) {
    const std::string name = fmt::format("model-{:02}", i);
    VICTORIOUS_ASSIGN_OR_RETURN(const ModelRecord model,
                                store.PutModel({.name = name, .content_id = name, .kind = ModelKind::kCad}));
    models.push_back(model.id);
  }
  std::vector<ObjectRecord> objects;
  for (int v = 0; v < sizes.videos; ++v) {
    const std::string name = fmt::format("/videos/{:04}.mp4", v);
    VICTORIOUS_ASSIGN_OR_RETURN(
        const VideoRecord video,
        store.PutVideo({.content_id = fmt::format("{:032}", v), .name = name, .width = 1920, .height = 1080}));
    const std::int64_t frames = 6000;
    VICTORIOUS_RETURN_IF_ERROR(store.SetVideoLength(video.id, frames, static_cast<double>(frames) / kFrameRate));
    // Flights over twenty towns of 10 km.
    const int town = v % 20;
    const double latitude = 47 + 0.35 * (town / 5);
    const double longitude = 6 + 1.3 * (town % 5);
    // Its camera goes over the town in rows.
    std::vector<GeoBox> shown;
    for (int i = 0; i < kShownBoxes; ++i) {
      const double south = RadiansFromDegrees(latitude - 0.05 + 0.0125 * (i / 8));
      const double west = RadiansFromDegrees(longitude - 0.06 + 0.015 * (i % 8));
      shown.push_back({south, west, south + RadiansFromDegrees(0.01), west + RadiansFromDegrees(0.01)});
    }
    VICTORIOUS_RETURN_IF_ERROR(store.PutShownGround(video.id, shown));
    IndexBatch batch;
    std::vector<ObjectRecord> found;
    for (int i = 0; i < sizes.objects; ++i) {
      const std::int64_t model = models[random.Below(kModels)];
      const double score = std::clamp(1 - std::abs(0.35 * random.Normal()), 0.01, 0.999);
      const auto first = static_cast<std::int64_t>(random.Uniform() * static_cast<double>(frames - sizes.sightings));
      batch.tracklets.push_back({std::nullopt,
                                 {.video = video.id,
                                  .model = model,
                                  .score = score,
                                  .frames = sizes.sightings,
                                  .first_time_s = static_cast<double>(first) / kFrameRate,
                                  .last_time_s = static_cast<double>(first + sizes.sightings - 1) / kFrameRate}});
      const double x = 1800 * random.Uniform();
      const double y = 1000 * random.Uniform();
      for (int s = 0; s < sizes.sightings; ++s) {
        const Box box{x + 0.2 * s, y, 60, 40};
        batch.sightings.push_back(
            {static_cast<std::size_t>(i),
             {.frame = first + s,
              .time_s = static_cast<double>(first + s) / kFrameRate,
              .box = box,
              .outline = {{box.x, box.y}, {box.x + 60, box.y}, {box.x + 60, box.y + 40}, {box.x, box.y + 40}},
              .score = score,
              .matches = 8 + static_cast<int>(random.Below(30))}});
      }
      ObjectRecord object{.model = model};
      Geolocation place{.point = {RadiansFromDegrees(latitude + 0.03 * random.Normal()),
                                  RadiansFromDegrees(longitude + 0.04 * random.Normal()), 200},
                        .time_s = static_cast<double>(first) / kFrameRate};
      const double sigma_m = 0.5 + 4 * random.Uniform();
      place.covariance_enu_m2 = Eigen::Vector3d(sigma_m * sigma_m, 4 * sigma_m * sigma_m, 1).asDiagonal();
      place.ce90_m = 3.3 * sigma_m;
      place.le90_m = 1.6;
      if (random.Uniform() < 0.9) object.place = place;
      object.heading_rad = 2 * kPi * random.Uniform();
      found.push_back(std::move(object));
    }
    for (const std::int64_t model : models) {
      batch.progress.push_back({{.video = video.id,
                                 .model = model,
                                 .next_frame = frames,
                                 .finished = true,
                                 .options_json = "{}",
                                 .program_version = "0"},
                                0});
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<std::int64_t> ids, store.Commit(batch));
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].id = ids[i];
      found[i].tracklets = {ids[i]};
      objects.push_back(std::move(found[i]));
    }
    if ((v + 1) % 100 == 0) fmt::print(stderr, "{} videos\n", v + 1);
  }
  VICTORIOUS_RETURN_IF_ERROR(store.PutObjects(objects));
  // Some are reviewed.
  const std::int64_t now_us = 1'700'000'000'000'000;
  for (std::size_t i = 0; i < std::min<std::size_t>(objects.size(), 1000); i += 5) {
    const Review review{.verdict = i % 2 == 0 ? Verdict::kAccepted : Verdict::kRejected,
                        .note = i % 10 == 0 ? "by the barn" : "",
                        .updated_utc_us = now_us,
                        .reviewer = "ann"};
    VICTORIOUS_RETURN_IF_ERROR(store.PutReview(objects[i].id, review));
  }
  return {};
}

}  // namespace
}  // namespace victorious

int main(int argc, char** argv) {
  victorious::Sizes sizes;
  int* const numbers[] = {&sizes.videos, &sizes.objects, &sizes.sightings};
  bool is_valid = argc >= 2 && argc <= 5;
  for (int i = 2; i < argc && is_valid; ++i) is_valid = (*numbers[i - 2] = std::atoi(argv[i])) > 0;
  if (!is_valid || sizes.sightings > 5000) {
    fmt::print(stderr,
               "usage: make-large-index FILE|URL [VIDEOS [OBJECTS_PER_VIDEO [SIGHTINGS_PER_OBJECT, at most 5000]]]\n");
    return 2;
  }
  if (victorious::HasIndex(argv[1]).value_or(false)) {
    fmt::print(stderr, "{}: exists already\n", victorious::StoreName(argv[1]));
    return 2;
  }
  const auto store = victorious::OpenStore(argv[1], victorious::StoreMode::kCreate);
  const victorious::Status filled =
      store ? victorious::Fill(**store, sizes) : victorious::Status(std::unexpected(store.error()));
  if (filled) return 0;
  fmt::print(stderr, "error: {}\n", filled.error().message);
  return 1;
}
