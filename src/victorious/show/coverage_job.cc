#include "victorious/show/coverage_job.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/object/model/model_library.h"
#include "victorious/place/cameras/clock_offset.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/show/sighting_evidence.h"
#include "victorious/store/catalogue.h"

namespace victorious {

void CoverageOptions::ListFields(FieldList& fields) {
  fields.AddGroup("detection", detection);
  fields.Add("cell_m", cell_m,
             {.min = 0.05,
              .max = 1e4,
              .unit = "m",
              .reason = "side of a cell of the ground; null: by the area, such that there are 250,000 cells at most, "
                        "and 1 m at least"});
  fields.Add("look_interval_s", look_interval_s,
             {.min = 0.01, .max = 100, .unit = "s", .reason = "between the frames whose ground is computed"});
  fields.Add("min_probability", min_probability,
             {.min = 0.01, .max = 1, .reason = "ground with less is a gap to fly again, and not counted as searched"});
}

namespace {

bool Contains(std::span<const SearchPart> parts, std::int64_t model, double time_s) {
  return std::ranges::any_of(parts, [&](const SearchPart& part) {
    const bool is_searched = part.kind == SearchPartKind::kSearched || part.kind == SearchPartKind::kThinned;
    return is_searched && part.model == model && part.from_s <= time_s && time_s <= part.to_s;
  });
}

// The times at which the ground is computed: those of photos, else at intervals from the first searched frame on.
std::vector<double> LookTimes(const CameraStates& cameras, std::span<const SearchPart> parts,
                              std::span<const std::int64_t> models, double interval_s) {
  constexpr double kMaxLooks = 50'000;
  std::vector<double> times_s;
  if (cameras.is_of_photos()) {
    for (const CameraState& state : cameras.trajectory()->states()) times_s.push_back(state.time_s);
  } else if (!parts.empty()) {
    const double from_s = std::ranges::min(parts, {}, &SearchPart::from_s).from_s;
    const double to_s = std::ranges::max(parts, {}, &SearchPart::to_s).to_s;
    const double step_s = std::max(interval_s, (to_s - from_s) / kMaxLooks);
    for (double time_s = from_s; time_s < to_s; time_s += step_s) times_s.push_back(time_s);
    times_s.push_back(to_s);
  }
  std::erase_if(times_s, [&](double time_s) {
    return !std::ranges::all_of(models, [&](std::int64_t model) { return Contains(parts, model, time_s); });
  });
  return times_s;
}

}  // namespace

std::optional<SearchedModel> SizeOf(const ObjectModel& model) {
  std::optional<double> diagonal_m = model.length_m;
  if (model.box_m) diagonal_m = model.box_m->diagonal().norm();
  if (!diagonal_m) return std::nullopt;
  return SearchedModel{.name = model.name, .diagonal_m = *diagonal_m};
}

std::vector<GroundLook> SearchedLooks(const VideoRecord& video, std::span<const SearchPart> parts,
                                      std::span<const std::int64_t> models, const CameraStates& cameras,
                                      const std::shared_ptr<const Ground>& ground, double interval_s) {
  std::vector<GroundLook> looks;
  if (!cameras.HasStates()) return looks;
  for (const double time_s : LookTimes(cameras, parts, models, interval_s)) {
    const std::optional<CameraState> camera = cameras.At(time_s);
    if (!camera || !camera->IsComplete()) continue;
    looks.push_back({.camera = *camera, .width_px = video.width, .height_px = video.height, .ground = ground});
  }
  return looks;
}

namespace {

// Why videos and models are left out, and what else is to be said: warnings if others are left, else an error.
class Reasons {
 public:
  void LeaveOut(const std::string& name, std::string_view why) {
    left_out_.push_back(fmt::format("{}: {}", name, why));
  }
  void Add(const std::string& line) { others_.push_back(line); }

  // `nothing` is the error if no reason is known.
  [[nodiscard]] std::unexpected<Error> Refuse(std::string_view nothing) const {
    if (left_out_.empty()) return Fail(ErrorCode::kInvalidArgument, fmt::format("coverage: {}", nothing));
    const std::size_t others = left_out_.size() - 1;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("coverage: {}{}", left_out_.front(),
                                                         others > 0 ? fmt::format("; and {} more", others) : ""));
  }

  void Warn(const WarningSink& warn) const {
    if (!warn) return;
    for (const std::string& line : others_) warn(line);
    for (const std::string& line : left_out_) warn(line + ": left out of the coverage");
  }

 private:
  std::vector<std::string> left_out_;
  std::vector<std::string> others_;
};

struct SizedModels {
  std::vector<SearchedModel> sized;
  std::vector<std::int64_t> ids;
};

SizedModels SizesOf(const Catalogue& catalogue, const CoverageRequest& request, Reasons& reasons) {
  const ModelLibrary library(request.models);
  SizedModels models;
  for (const ModelRecord& model : catalogue.models()) {
    if (model.IsCategory()) continue;
    const Expected<ObjectModel> loaded = library.Load(model.name);
    if (!loaded) {
      reasons.LeaveOut(model.name, loaded.error().message);
      continue;
    }
    const std::optional<SearchedModel> sized = SizeOf(*loaded);
    if (!sized) {
      reasons.LeaveOut(model.name, "it has no size in metres (`model add --length`)");
      continue;
    }
    models.sized.push_back(*sized);
    models.ids.push_back(model.id);
  }
  return models;
}

class VideoLooks {
 public:
  VideoLooks(IndexStore& store, const CoverageRequest& request, const CancelToken& cancel, Reasons& reasons)
      : store_(store), request_(request), cancel_(cancel), reasons_(reasons) {}

  // Adds the frames of a video whose cameras and ground are known. Errors: those of the store, kCancelled, and those of
  // a telemetry file that was given.
  Status Add(const VideoRecord& video, const std::vector<std::int64_t>& models, std::vector<GroundLook>& looks) const {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, store_.SearchParts(video.id));
    if (ShownName(video).contains("://")) return Skip(video, "a live source has no telemetry of the past");
    VICTORIOUS_ASSIGN_OR_RETURN(const CameraStates cameras, LoadCameras(video, models.front()));
    if (!cameras.HasStates()) return Skip(video, "coverage needs telemetry with positions, and it has none");
    VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const Ground> ground, GroundOf(video, cameras));
    if (ground == nullptr) return Skip(video, "the height of its ground is unknown: give --ground or --terrain");
    const std::vector<GroundLook> added =
        SearchedLooks(video, parts, models, cameras, ground, request_.options.look_interval_s);
    if (added.empty()) {
      return Skip(video,
                  "no time was searched for all of the models with a known height above the ellipsoid, attitude and "
                  "field of view of the camera: select one model with --model");
    }
    looks.insert(looks.end(), added.begin(), added.end());
    return {};
  }

 private:
  Status Skip(const VideoRecord& video, std::string_view why) const {
    reasons_.LeaveOut(ShownName(video), why);
    return {};
  }

  [[nodiscard]] Expected<CameraStates> LoadCameras(const VideoRecord& video, std::int64_t model) const {
    TelemetryOptions options;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store_.FindSearch(video.id, model));
    if (search) {
      const Expected<TelemetryOptions> searched = TelemetryOptionsOf(search->options_json);
      if (searched) options = *searched;
    }
    const std::string path = FindVideoFile(video);
    const WarningSink warn = [this](const std::string& line) { reasons_.Add(line); };
    VICTORIOUS_RETURN_IF_ERROR(request_.roots.Check(path));
    const auto file =
        request_.telemetry ? request_.telemetry : RememberedTelemetry(video.telemetry, request_.roots, warn);
    VideoInfo info;
    info.duration_s = video.duration_s;
    info.width = video.width;
    info.height = video.height;
    VICTORIOUS_ASSIGN_OR_RETURN(CameraStates cameras,
                                CameraStates::Load(path, info, file, options, "no ground is covered", warn));
    VICTORIOUS_RETURN_IF_ERROR(
        CorrectTelemetry(path, IndexOptions().features.impulse_fraction, FindGiven(options), cancel_, warn, cameras));
    return cameras;
  }

  [[nodiscard]] Expected<std::shared_ptr<const Ground>> GroundOf(const VideoRecord& video,
                                                                 const CameraStates& cameras) const {
    if (request_.ground != nullptr) return request_.ground;
    const std::optional<GroundHeight>& seen = cameras.ground_height();
    if (seen && seen->datum == VerticalDatum::kEllipsoid) return std::make_shared<const FlatGround>(seen->height_m);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store_.Objects({.video = video.id}));
    std::vector<double> heights_m;
    for (const ObjectRecord& object : objects) {
      if (object.place) heights_m.push_back(object.place->point.altitude_m);
    }
    if (heights_m.empty()) return nullptr;
    return std::make_shared<const FlatGround>(Median(heights_m));
  }

  IndexStore& store_;
  const CoverageRequest& request_;
  const CancelToken& cancel_;
  Reasons& reasons_;
};

}  // namespace

Expected<GroundCoverage> CoverIndex(IndexStore& store, const SightingFilter& filter, const CoverageRequest& request,
                                    const CancelToken& cancel) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(request.options));
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  Reasons reasons;
  const SizedModels models = SizesOf(catalogue, request, reasons);
  if (models.sized.empty()) return reasons.Refuse("no model was searched for");
  std::vector<GroundLook> looks;
  for (const VideoRecord& video : catalogue.videos()) {
    if (cancel.IsCancelled()) return Fail(ErrorCode::kCancelled, "coverage: cancelled");
    VICTORIOUS_RETURN_IF_ERROR(VideoLooks(store, request, cancel, reasons).Add(video, models.ids, looks));
  }
  if (looks.empty()) return reasons.Refuse("the index has no video");
  reasons.Warn(request.warn);
  GridRequest grid{.cell_m = request.options.cell_m, .centre = {}};
  if (filter.near) {
    grid.centre = filter.near->centre;
    grid.radius_m = filter.near->radius_m;
  }
  return CoverGround(looks, models.sized, request.options.detection, grid);
}

}  // namespace victorious
