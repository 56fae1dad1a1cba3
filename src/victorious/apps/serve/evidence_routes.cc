#include "victorious/apps/serve/evidence_routes.h"

#include <algorithm>
#include <optional>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/decoder/crop.h"
#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/index_lookup.h"
#include "victorious/apps/serve/request_slot.h"
#include "victorious/apps/serve/static_files.h"
#include "victorious/base/json.h"
#include "victorious/base/median.h"
#include "victorious/base/options.h"
#include "victorious/input/image/image_file.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/view_surface.h"
#include "victorious/show/coverage_job.h"
#include "victorious/show/export/export_coverage.h"
#include "victorious/show/sighting_evidence.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxCameras = 4;     // trajectories of some megabytes
constexpr std::size_t kMaxEvidence = 64;   // bodies of at most 150 kB
constexpr std::size_t kMaxCoverages = 16;  // bodies of at most some megabytes
constexpr std::size_t kMaxModels = 8;      // mapped files of 9 to 32 MB: a turning model asks for hundreds of views

ApiExpected<bool> ReadWhole(QueryReader& query) {
  const auto size = query.Text("size");
  if (!size || *size == "small") return false;
  if (*size == "full") return true;
  return FailField("size", fmt::format("size \"{}\": must be one of small, full", *size));
}

}  // namespace

EvidenceRoutes::EvidenceRoutes(IndexView& index, VideoFiles& videos, std::filesystem::path models)
    : index_(index),
      videos_(videos),
      models_folder_(std::move(models)),
      cameras_(kMaxCameras),
      bodies_(kMaxEvidence),
      coverages_(kMaxCoverages),
      models_(kMaxModels) {}

ApiExpected<std::shared_ptr<const ObjectModel>> EvidenceRoutes::LoadModel(const ModelRecord& record) {
  if (record.IsBoxed()) {
    return NotFound("a person boxed it, and it was followed from there: it has neither views nor matches");
  }
  if (record.IsCategory()) {
    return NotFound(fmt::format("{} is a category: it has neither views nor matches", record.name));
  }
  if (models_folder_.empty()) {
    return NotFound(
        fmt::format("the views of {} are not known: `victorious serve --models DIR` names the models", record.name));
  }
  const ModelLibrary library(models_folder_);
  // A file that was replaced has another tag, one that is gone has none.
  const std::string state = FileEtag(library.PathOf(record.name));
  VICTORIOUS_ASSIGN_OR_RETURN(auto model,
                              models_.Get(record.name + " " + state, [&] { return library.Load(record.name); }));
  if (model->id == record.content_id) return model;
  return std::unexpected(
      ApiError(Error{ErrorCode::kConflict, fmt::format("{}: the model in {} is not the one that was searched for",
                                                       record.name, models_folder_.string())}));
}

ApiExpected<std::shared_ptr<const ObjectModel>> EvidenceRoutes::LoadModelOf(std::string_view id) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(id, "model"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  const ModelRecord* record = lists->Model(number);
  if (record == nullptr) return NotFound(fmt::format("model {} is not in the index", number));
  return LoadModel(*record);
}

ApiExpected<HttpResponse> EvidenceRoutes::Views(const ApiCall& call) {
  constexpr std::int64_t kMaxObjects = 200;  // whose sightings are read
  VICTORIOUS_ASSIGN_OR_RETURN(const auto model, LoadModelOf(call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TriageObject> objects,
                              reader->objects->Objects({.models = {model->name}}, {.limit = kMaxObjects}));
  Json sightings = Json::array();
  for (const TriageObject& one : objects) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SightingRecord> best, reader->objects->BestSighting(one.object.id));
    if (best) sightings.push_back(SightingToJson(*best));
  }
  return JsonResponse(ModelViewsToJson(*model, std::move(sightings)));
}

ApiExpected<HttpResponse> EvidenceRoutes::ViewImage(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(call.parameters[1], "view"));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool is_full, ReadWhole(call.query));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  VICTORIOUS_ASSIGN_OR_RETURN(const auto loaded, LoadModelOf(call.parameters[0]));
  const ObjectModel& model = *loaded;
  const auto view = static_cast<std::size_t>(number);
  if (number >= std::ssize(model.views) || model.views[view].thumbnail.empty()) {
    return NotFound(fmt::format("{} has {} views; view {} has no image", model.name, model.views.size(), view));
  }
  std::span<const std::byte> bytes = model.views[view].thumbnail;
  std::vector<std::byte> rendering;
  if (is_full && !model.views[view].surface.empty()) {
    constexpr int kQuality = 90;
    VICTORIOUS_ASSIGN_OR_RETURN(const ViewSurface surface, DecodeSurface(model.views[view].surface, model.name));
    VICTORIOUS_ASSIGN_OR_RETURN(rendering, EncodeJpeg(surface.grey, kQuality));
    bytes = rendering;
  }
  return TaggedResponse(call.request, "image/jpeg", {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, 60);
}

// The best sighting of an object, or the one of a frame.
ApiExpected<SightingRecord> EvidenceRoutes::ReadSighting(std::int64_t object, QueryReader& query) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto video, query.Integer("video", 0, INT64_MAX));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto frame, query.Integer("frame", 0, INT64_MAX));
  VICTORIOUS_RETURN_IF_ERROR(query.CheckAllUsed());
  if (video.has_value() != frame.has_value()) {
    return FailField(video ? "frame" : "video", "video and frame: give both of them or none");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  if (!video) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::optional<SightingRecord> best, reader->objects->BestSighting(object));
    if (best) return *std::move(best);
    return NotFound(fmt::format("object {} has no sighting", object));
  }
  std::optional<SightingRecord> found;
  VICTORIOUS_RETURN_IF_ERROR(
      reader->sightings->VisitSightings({.object = object, .video = *video}, [&](SightingRecord&& sighting) {
        if (sighting.frame == *frame) found = std::move(sighting);
        return sighting.frame < *frame;
      }));
  if (found) return *std::move(found);
  return NotFound(fmt::format("object {} has no sighting in frame {} of video {}", object, *frame, *video));
}

Expected<std::string> EvidenceRoutes::Make(const SightingRecord& sighting, const VideoRecord& video,
                                           const std::string& options_json, const ObjectModel& model,
                                           const CancelToken& cancel) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(video));
  VICTORIOUS_ASSIGN_OR_RETURN(const TelemetryOptions telemetry, TelemetryOptionsOf(options_json));
  if (!telemetry.geoid_grid.empty()) VICTORIOUS_RETURN_IF_ERROR(videos_.roots().files().Check(telemetry.geoid_grid));
  const auto load = [&] {
    return videos_.Cameras(video, path, telemetry, [](const std::string& /*warning*/) {}, cancel);
  };
  VICTORIOUS_ASSIGN_OR_RETURN(
      const auto cameras,
      GetUnlessCancelled(cameras_,
                         fmt::format("{} {} {}", video.content_id, video.telemetry, OptionsToJsonText(telemetry)),
                         cancel, load));
  const RequestSlot slot(slots_);
  if (!slot.is_taken()) return Fail(ErrorCode::kConflict, "others ask for evidence, too: ask again in a moment");
  VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat grey, videos_.GreyFrame(video, sighting.time_s, cancel));
  VICTORIOUS_ASSIGN_OR_RETURN(const MatchEvidence evidence,
                              ExplainSighting(sighting, options_json, model, grey, *cameras));
  const ModelView& view = model.views[static_cast<std::size_t>(sighting.view_index)];
  return DumpJson(EvidenceToJson(evidence, sighting, view, CropRegion(sighting.box, grey.cols, grey.rows))) + "\n";
}

ApiExpected<HttpResponse> EvidenceRoutes::Get(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const TriageObject object, FindObject(index_, call.parameters[0]));
  VICTORIOUS_ASSIGN_OR_RETURN(const SightingRecord sighting, ReadSighting(object.object.id, call.query));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  const VideoRecord* video = lists->Video(sighting.video);
  const ModelRecord* record = lists->Model(sighting.model);
  if (video == nullptr || record == nullptr) return NotFound("the sighting is not in the index any more");
  VICTORIOUS_ASSIGN_OR_RETURN(const auto model, LoadModel(*record));
  // Asked before the cache, so that evidence ends with its video.
  VICTORIOUS_RETURN_IF_ERROR(videos_.Find(*video));
  std::optional<SearchRecord> search;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(search, reader->sightings->FindSearch(video->id, record->id));
  }
  if (!search) return NotFound("the search that found it is not in the index any more");
  const std::string key = fmt::format("{} {} {} {} {:.2f} {:.2f} {} {} {}", video->content_id, model->id,
                                      sighting.frame, sighting.view_index, sighting.box.x, sighting.box.y, video->id,
                                      object.object.id, search->options_json);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto body, GetUnlessCancelled(bodies_, key, call.cancel, [&] {
                                return Make(sighting, *video, search->options_json, *model, call.cancel);
                              }));
  return TaggedResponse(call.request, "application/json", *body, 0);
}

Expected<std::string> EvidenceRoutes::MakeCoverage(const VideoRecord& video, std::int64_t model_id,
                                                   const ObjectModel& model, double ground_m,
                                                   const CancelToken& cancel) {
  constexpr double kMaxLooks = 3000;  // of a long video
  constexpr double kMaxCells = 40'000;
  const CoverageOptions options;
  const std::optional<SearchedModel> sized = SizeOf(model);
  if (!sized) return Fail(ErrorCode::kNotFound, fmt::format("{} has no size in metres", model.name));
  std::vector<SearchPart> parts;
  std::optional<SearchRecord> search;
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(parts, reader->sightings->SearchParts(video.id));
    VICTORIOUS_ASSIGN_OR_RETURN(search, reader->sightings->FindSearch(video.id, model_id));
  }
  TelemetryOptions telemetry;
  if (const auto searched = TelemetryOptionsOf(search ? search->options_json : "{}")) telemetry = *searched;
  if (!telemetry.geoid_grid.empty()) VICTORIOUS_RETURN_IF_ERROR(videos_.roots().files().Check(telemetry.geoid_grid));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::filesystem::path path, videos_.Find(video));
  VICTORIOUS_ASSIGN_OR_RETURN(const CameraStates cameras,
                              videos_.Cameras(video, path, telemetry, [](const std::string& /*warning*/) {}, cancel));
  const double interval_s = std::max(options.look_interval_s, video.duration_s.value_or(0) / kMaxLooks);
  const std::vector<GroundLook> looks = SearchedLooks(video, parts, std::span(&model_id, 1), cameras,
                                                      std::make_shared<const FlatGround>(ground_m), interval_s);
  const auto coverage =
      CoverGround(looks, {*sized}, options.detection, {.cell_m = {}, .max_cells = kMaxCells, .centre = {}});
  if (!coverage) {
    return Fail(ErrorCode::kNotFound,
                "the searched ground is not known: it needs telemetry with positions, attitudes and fields of view");
  }
  std::ostringstream body;
  VICTORIOUS_RETURN_IF_ERROR(WriteCoverageGeoJson(*coverage, options.min_probability, body));
  return body.str();
}

ApiExpected<HttpResponse> EvidenceRoutes::Coverage(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t number, ParseId(call.parameters[0], "model"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto of_video, call.query.Integer("video", 0, INT64_MAX));
  VICTORIOUS_RETURN_IF_ERROR(call.query.CheckAllUsed());
  if (!of_video) return FailField("video", "video: give the id of one");
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  const ModelRecord* record = lists->Model(number);
  const VideoRecord* video = lists->Video(*of_video);
  if (record == nullptr) return NotFound(fmt::format("model {} is not in the index", number));
  if (video == nullptr) return NotFound(fmt::format("video {} is not in the index", *of_video));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto model, LoadModel(*record));
  VICTORIOUS_RETURN_IF_ERROR(videos_.Find(*video));
  std::vector<double> heights_m;
  std::string searched;  // what was searched changes with the index
  {
    VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
    VICTORIOUS_ASSIGN_OR_RETURN(heights_m, reader->objects->PlaceHeights(video->id));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SearchPart> parts, reader->sightings->SearchParts(video->id));
    for (const SearchPart& part : parts) {
      if (part.model == number) searched += fmt::format(" {} {}", part.from_frame, part.to_frame);
    }
  }
  if (heights_m.empty()) {
    return NotFound(
        "no object of the video with a place gives the height of its ground: `victorious export --format coverage` "
        "estimates it");
  }
  const double ground_m = Median(heights_m);
  const std::string key =
      fmt::format("{} {} {} {} {}{}", video->content_id, video->telemetry, video->id, model->id, ground_m, searched);
  VICTORIOUS_ASSIGN_OR_RETURN(const auto body, GetUnlessCancelled(coverages_, key, call.cancel, [&] {
                                return MakeCoverage(*video, number, *model, ground_m, call.cancel);
                              }));
  return TaggedResponse(call.request, "application/json", *body, 0);
}

}  // namespace victorious
