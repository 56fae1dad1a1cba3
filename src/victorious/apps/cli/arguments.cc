#include "victorious/apps/cli/arguments.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <ranges>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "victorious/base/check.h"
#include "victorious/base/count_text.h"
#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/text.h"
#include "victorious/base/write_access.h"
#include "victorious/geometry/angles.h"
#include "victorious/input/image/image_file.h"
#include "victorious/input/telemetry/camera_models.h"
#include "victorious/jobs/preset.h"
#include "victorious/store/open_store.h"
#include "victorious/types/vertical_datum.h"

namespace victorious::cli {

namespace {

// Parses kCount finite, comma-separated numbers; std::nullopt for any other text.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> ParseNumbers(std::string_view text) {
  std::array<double, kCount> numbers{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool separated = i + 1 < kCount ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !separated || !std::isfinite(numbers[i])) return std::nullopt;
    at = next + 1;
  }
  return numbers;
}

}  // namespace

Expected<GeoCircle> ParseGeoCircle(std::string_view text) {
  const auto numbers = ParseNumbers<3>(text);
  if (!numbers || std::abs((*numbers)[0]) > 90 || std::abs((*numbers)[1]) > 360 || (*numbers)[2] < 0) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--near \"{}\": must be latitude and longitude in degrees and a distance in metres, as in "
                            "52.52,13.40,50",
                            text));
  }
  return GeoCircle{{RadiansFromDegrees((*numbers)[0]), RadiansFromDegrees((*numbers)[1]), 0}, (*numbers)[2]};
}

Expected<Box> ParseBox(std::string_view text) {
  const auto numbers = ParseNumbers<4>(text);
  if (!numbers) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("box \"{}\": must be x,y,w,h in pixels, as in 10,20,300,200", text));
  }
  const Box box{(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
  if (box.IsEmpty())
    return Fail(ErrorCode::kInvalidArgument, fmt::format("box \"{}\": width and height must be above 0", text));
  return box;
}

namespace {

// Parses the whole text as a finite number of at least 0.
std::optional<double> ParseNonNegative(std::string_view text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || next != end || !std::isfinite(number) || std::signbit(number)) return std::nullopt;
  return number;
}

// Parses [[hours:]minutes:]seconds. Only the first part may be 60 or more; only the last part may have a fraction.
std::optional<double> ParseSeconds(std::string_view text) {
  constexpr int kMaxParts = 3;
  double seconds = 0;
  for (int part = 0; part < kMaxParts; ++part) {
    const std::size_t colon = text.find(':');
    const bool last = colon == std::string_view::npos;
    const std::string_view digits = text.substr(0, colon);
    const std::optional<double> number = ParseNonNegative(digits);
    const bool alone = part == 0 && last;  // a single part may have an exponent
    const bool plain = digits.find_first_not_of(last ? "0123456789." : "0123456789") == std::string_view::npos;
    if (!number || !(plain || alone) || (part > 0 && *number >= 60)) return std::nullopt;
    seconds = 60 * seconds + *number;
    if (last) return seconds;
    text.remove_prefix(colon + 1);
  }
  return std::nullopt;
}

}  // namespace

Expected<double> ParseTime(std::string_view text) {
  if (const std::optional<double> seconds = ParseSeconds(text)) return *seconds;
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("\"{}\": must be a time of at least 0, in seconds or as 1:30 or 1:02:03.5", text));
}

Status NormalizeVideoTime(std::string& text) {
  VICTORIOUS_ASSIGN_OR_RETURN(const double seconds, ParseTime(text));
  text = fmt::format("{}", seconds);
  return {};
}

void AddDb(ArgumentParser& parser, std::string& db, std::string_view description) {
  parser.Add("--db", db, fmt::format("{}: a file, or postgresql://USER@HOST/DATABASE", description))
      .Required()
      .TypeName("DB");
}

void AddFilesBelow(ArgumentParser& parser, std::vector<std::string>& folders) {
  parser
      .Add("--files-below", folders,
           "For jobs of `serve`: of the files that the index names, open only those below this folder; repeatable")
      .TypeName("DIR")
      .OneValueEach();
}

FileRoots RootsOf(const std::vector<std::string>& folders) {
  return folders.empty() ? FileRoots() : FileRoots({folders.begin(), folders.end()});
}

Status CheckSharedDatabase(const std::string& db) {
  if (IsDatabaseUrl(db)) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--db {}: workers share a database: give postgresql://USER@HOST/DATABASE", db));
}

void AddParams(ArgumentParser& parser, std::string& params, std::string_view lists) {
  parser
      .Add("--params", params,
           fmt::format("Parameters: JSON (`victorious params {}` lists them), or a preset: {}", lists,
                       fmt::join(Texts(kPresetTexts), ", ")))
      .TypeName("FILE");
}

void AddSearchSettings(ArgumentParser& parser, SearchSettings& search) {
  AddParams(parser, search.params, "index");
  parser
      .Add("--quality", search.quality,
           "fast: a whole frame each 0.4 to 0.7 s, by how far the image moves, found objects tracked in between, CAD "
           "models by proposals; normal (default): each 0.2 to 0.7 s; thorough: all frames, more candidates of each "
           "match (docs/tutorial.md)")
      .TypeName("NAME");
  parser
      .Add("--every", search.every,
           "Search every N-th frame completely; in between, only regions around tracked objects; 0: by the "
           "frame rate; default: by --quality")
      .Range(0, 1'000'000)
      .TypeName("N");
}

Expected<IndexOptions> ReadIndexOptions(const SearchSettings& search, std::span<const ObjectModel> models) {
  IndexOptions options;
  if (!search.quality.empty()) {
    const bool cad_only =
        std::ranges::all_of(models, [](const ObjectModel& one) { return one.kind == ModelKind::kCad; });
    VICTORIOUS_ASSIGN_OR_RETURN(const Quality quality, ParseQuality(search.quality));
    ApplyQuality(quality, cad_only, options);
  }
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(search.params, options));
  if (search.every) options.every = *search.every;
  VICTORIOUS_RETURN_IF_ERROR(CheckFlags(CollectFields(options), {{"every", "--every"}}));
  return options;
}

void AddFieldOfView(ArgumentParser& parser, std::optional<double>& hfov_deg) {
  const auto check = [](const std::string& text) -> Status {
    const std::optional<double> degrees = ParseNonNegative(text);
    if (degrees && *degrees > 0 && *degrees < 180) return {};
    return Fail(ErrorCode::kInvalidArgument, fmt::format("\"{}\": must be above 0 and below 180 degrees", text));
  };
  parser.Add("--hfov", hfov_deg, "The camera's full horizontal field of view in degrees; overrides telemetry")
      .Check(check)
      .TypeName("DEG");
}

void AddCamera(ArgumentParser& parser, CameraArguments& camera) {
  const Argument pitch =
      parser
          .Add("--pitch", camera.pitch_deg,
               "Elevation of the optical axis in degrees, -90 straight down, if the telemetry has no gimbal "
               "angles; without --yaw the camera looks in the direction of flight")
          .Range(-90.0, 90.0)
          .TypeName("DEG");
  parser.AddFlag("--nadir", camera.nadir, "The same as --pitch -90").Excludes(pitch);
  parser
      .Add("--yaw", camera.yaw_deg,
           "Direction of the optical axis in degrees clockwise from north; with --pitch or --nadir")
      .Range(-360.0, 360.0)
      .TypeName("DEG");
  parser.Add("--takeoff", camera.takeoff_m, "Height of the take-off above the ellipsoid, in metres")
      .Range(-1e3, 9e3)
      .TypeName("METRES");
  parser.Add("--vertical-datum", camera.vertical_datum, "What telemetry's heights are above; overrides telemetry")
      .OneOf(DatumOverrideTexts<VerticalDatum::kTakeoff>());
  parser
      .Add("--gps-order", camera.gps_order,
           "Order of latitude and longitude in subtitles with GPS(a, b, height), if letters do not tell it")
      .OneOf(kGpsOrderTexts);
  const auto check = [](const std::string& text) -> Status {
    if (FindCameraModel(text) != nullptr) return {};
    const auto names = CameraModels() | std::views::transform(&CameraModel::aircraft);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("\"{}\": unknown; give --hfov, or one of {}", text, fmt::join(names, ", ")));
  };
  parser
      .Add("--camera", camera.camera,
           "The aircraft or camera, for its field of view, if the telemetry has none or only a focal length: "
           "\"mavic-pro\", or the model that its photos name, \"FC220\"")
      .Check(check)
      .TypeName("NAME");
}

Status ApplyCamera(const CameraArguments& arguments, TelemetryOptions& options) {
  if (arguments.yaw_deg && !arguments.pitch_deg && !arguments.nadir) {
    return Fail(ErrorCode::kInvalidArgument,
                "--yaw: needs the elevation of the optical axis, too: give --pitch or --nadir");
  }
  constexpr double kNadir_deg = -90;
  if (arguments.pitch_deg) options.camera_pitch_deg = arguments.pitch_deg;
  if (arguments.nadir) options.camera_pitch_deg = kNadir_deg;
  options.camera_yaw_deg = arguments.yaw_deg;
  options.camera_model = arguments.camera;
  if (arguments.takeoff_m) options.takeoff_altitude_m = *arguments.takeoff_m;
  if (!arguments.vertical_datum.empty())
    options.vertical_datum = FromText(kVerticalDatumTexts, arguments.vertical_datum);
  if (const auto order = FromText(kGpsOrderTexts, arguments.gps_order)) options.gps_order = *order;
  return {};
}

void AddGround(ArgumentParser& parser, GroundArguments& ground) {
  parser.Add("--ground", ground.height_m, "Height of flat ground above the ellipsoid, in metres")
      .Range(-1e3, 1e5)
      .TypeName("METRES");
  parser.Add("--terrain", ground.terrain, "Terrain heights as a GeoTIFF, used instead of flat ground").TypeName("FILE");
  parser.Add("--terrain-datum", ground.vertical_datum, "Vertical datum of the terrain heights; overrides the file's")
      .OneOf({"ellipsoid", "egm96", "egm2008"});
  parser
      .Add("--geoid", ground.geoid_grid,
           "A .gtx geoid grid to which the terrain heights refer (default: the EGM96 grid of PROJ)")
      .TypeName("FILE");
}

void ApplyGround(const GroundArguments& arguments, GroundOptions& options) {
  if (arguments.height_m) options.height_m = *arguments.height_m;
  if (!arguments.terrain.empty()) options.terrain = arguments.terrain;
  if (!arguments.vertical_datum.empty())
    options.vertical_datum = FromText(kVerticalDatumTexts, arguments.vertical_datum);
  if (!arguments.geoid_grid.empty()) options.geoid_grid = arguments.geoid_grid;
}

Status ReadParamsFile(const std::string& path, const std::vector<FieldRef>& fields) {
  if (path.empty()) return {};
  constexpr std::size_t kMaxBytes = 1 << 20;
  const bool looks_like_a_name = path.find_first_of("./") == std::string::npos;
  std::error_code unknown;  // ignored: such a name is no file
  if (looks_like_a_name && !std::filesystem::exists(path, unknown)) {
    return Fail(ErrorCode::kNotFound, fmt::format("--params {}: neither a file nor a preset; presets are {}", path,
                                                  fmt::join(Texts(kPresetTexts), ", ")));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  const auto json = ParseJson(text);
  if (!json) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: {}: parameters are an object such as {{\"match\": {{\"ratio\": 0.8}}}}", path,
                            json.error().message));
  }
  if (auto status = SetFromJson(*json, fields); !status)
    return std::unexpected(std::move(status).error().WithContext(path));
  return {};
}

Status CheckFlags(const std::vector<FieldRef>& fields, std::initializer_list<FieldFlag> flags) {
  std::vector<FieldRef> set_by_flags;
  for (const FieldFlag& one : flags) {
    const auto field = std::ranges::find(fields, one.field, &FieldRef::name);
    VICTORIOUS_CHECK(field != fields.end());
    set_by_flags.push_back({std::string(one.flag), field->value, field->spec});
  }
  return Validate(set_by_flags);
}

Status WriteOutput(const std::string& path, std::string_view text) {
  if (!IsStandardOutput(path)) return WriteFileAtomically(path, text);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    return std::unexpected(ErrorFromErrno(errno, "write to standard output"));
  }
  return {};
}

Status WriteOutput(const std::string& path, const WriteContent& write) {
  if (!IsStandardOutput(path)) return WriteFileInParts(path, write);
  if (std::fflush(stdout) != 0) return std::unexpected(ErrorFromErrno(errno, "write to standard output"));
  return WriteInParts(STDOUT_FILENO, "to standard output", write);
}

Status CheckOutput(const std::string& path) {
  if (IsStandardOutput(path)) return {};
  namespace fs = std::filesystem;
  std::error_code unknown;
  const fs::file_status status = fs::status(path, unknown);
  if (status.type() == fs::file_type::none) {  // a name that is too long, a folder that may not be looked into
    return std::unexpected(ErrorFromErrno(unknown.value(), fmt::format("write {}", path)));
  }
  fs::path written = path;  // a device or a pipe is written directly
  if (fs::is_regular_file(status) || !fs::exists(status)) {
    // An atomic write creates a new file in the folder.
    written = fs::weakly_canonical(fs::absolute(path, unknown), unknown).parent_path();
  }
  if (!fs::is_directory(status) && IsWritable(written)) return {};
  return std::unexpected(ErrorFromErrno(fs::is_directory(status) ? EISDIR : errno, fmt::format("write {}", path)));
}

Status CheckDrawnImage(const std::string& path) {
  VICTORIOUS_RETURN_IF_ERROR(CheckImageName(path));
  return CheckOutput(path);
}

Status CheckDrawnVideo(const std::string& path) {
  if (path.empty()) return {};
  const std::string extension = LowerCase(std::filesystem::path(path).extension().string());
  if (extension != ".mp4" && extension != ".mkv") {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: a video's name must end in .mp4 or .mkv", path));
  }
  return CheckOutput(path);
}

namespace {

volatile std::sig_atomic_t interrupt_signal = 0;

}  // namespace

int InterruptSignal() { return interrupt_signal; }

CancelToken& Interrupt() {
  static CancelToken token;
  static const bool installed = [] {
    const auto handler = [](int signal) {  // may run before `installed` is set
      interrupt_signal = signal;
      token.Cancel();
    };
    std::signal(SIGINT, handler);
    std::signal(SIGTERM, handler);
    return true;
  }();
  static_cast<void>(installed);
  return token;
}

void FilterArguments::AddTo(ArgumentParser& parser) {
  parser.Add("--video", video, "Only this video: its indexed name, or the last parts of its path").TypeName("NAME");
  parser.Add("--model", model, "Only this model").TypeName("NAME");
  parser.Add("--category", category, "Only this category and its subcategories").TypeName("NAME");
  parser.Add("--from", from_s, "Only from this video time on: seconds, or as 1:30 or 1:02:03.5")
      .TypeName("TIME")
      .Transform(&NormalizeVideoTime);
  parser.Add("--to", to_s, "Only up to this video time").TypeName("TIME").Transform(&NormalizeVideoTime);
  parser.Add("--near", near, "Only objects within this distance of a place (degrees, metres)")
      .TypeName("LAT,LON,METRES");
  parser.Add("--object", object, "Only the object of this id").TypeName("ID");
  parser.AddFlag("--rejected", rejected, "Include rejected objects, with the reason");
  parser.AddFlag("--weak", weak,
                 fmt::format("Include weak finds: objects of models that score below {:g}, and are more likely false "
                             "than right",
                             kWeakScore));
  parser
      .Add("--thresholds", thresholds,
           "applied: without the objects that nobody has reviewed and that score less than the threshold that reviews "
           "have set for their model; ignored: with them")
      .OneOf({std::string(ToText(kThresholdUseTexts, ThresholdUse::kApplied)),
              std::string(ToText(kThresholdUseTexts, ThresholdUse::kIgnored))})
      .ShowDefault();
}

Expected<SightingFilter> FilterArguments::Filter() const {
  if (from_s && to_s && *from_s > *to_s) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("--from {:g} is after --to {:g}: --to must be the later time", *from_s, *to_s));
  }
  if (!model.empty() && !category.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "--model and --category exclude each other: give one of them");
  }
  SightingFilter filter;
  if (!near.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(filter.near, ParseGeoCircle(near));
  }
  if (!model.empty()) filter.model_name = model;
  if (!category.empty()) filter.category_name = category;
  if (!video.empty()) filter.video_name = video;
  filter.from_s = from_s;
  filter.to_s = to_s;
  filter.include_rejected = rejected;
  filter.object = object;
  filter.thresholds = FromText(kThresholdUseTexts, thresholds).value_or(ThresholdUse::kIgnored);
  filter.without_weak = !weak && !object;  // one that is asked for by its number is meant
  return filter;
}

Expected<std::string> ExplainScores(const SightingFilter& filter, IndexStore& store) {
  if (!filter.without_weak && filter.thresholds == ThresholdUse::kIgnored) return "";
  SightingFilter wider = filter;
  const auto count = [&]() -> Expected<std::size_t> {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> matching, store.Objects(wider));
    return matching.size();
  };
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t listed, count());
  wider.without_weak = false;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t with_weak, count());
  std::size_t all = with_weak;
  if (std::exchange(wider.thresholds, ThresholdUse::kIgnored) == ThresholdUse::kApplied) {
    VICTORIOUS_ASSIGN_OR_RETURN(all, count());
  }
  std::vector<std::string> said;
  if (const std::size_t weak = with_weak - std::min(with_weak, listed); weak > 0) {
    said.push_back(fmt::format("{} left out: {} below {:g} (--weak lists {})", CountText(weak, "weak find"),
                               weak == 1 ? "it scores" : "they score", kWeakScore, weak == 1 ? "it" : "them"));
  }
  if (const std::size_t below = all - std::min(all, with_weak); below > 0) {
    said.push_back(fmt::format("{} below the threshold of {} left out (--thresholds ignored lists {})",
                               CountText(below, "object"), below == 1 ? "its model is" : "their models are",
                               below == 1 ? "it" : "them"));
  }
  return fmt::format("{}", fmt::join(said, "; "));
}

Status CheckObject(const SightingFilter& filter, IndexStore& store) {
  if (!filter.object) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> found,
                              store.Objects({.include_rejected = true, .object = filter.object}));
  if (!found.empty()) return {};
  return Fail(ErrorCode::kNotFound,
              fmt::format("object {}: not in the index: `victorious search --rejected` lists its ids", *filter.object));
}

namespace {

// Why no object matches filter.near; empty if one matches, or if filter.near is not set.
Expected<std::string> ExplainNoObjectNear(SightingFilter filter, IndexStore& store) {
  if (!filter.near) return "";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> near, store.Objects(filter));
  filter.near.reset();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> matching, store.Objects(filter));
  if (!near.empty() || matching.empty()) return "";
  const auto placed = std::ranges::count_if(matching, [](const ObjectRecord& one) { return one.place.has_value(); });
  if (placed == 0) {
    return fmt::format("--near: none of the {} matching objects has a place: index the videos with telemetry",
                       matching.size());
  }
  return fmt::format("--near: {} of the {} matching objects have a place, and all are farther away", placed,
                     matching.size());
}

// "--model truck, --from 5": the flags that leave out objects.
std::string FlagsText(const SightingFilter& filter) {
  std::vector<std::string> flags;
  if (filter.video_name) flags.push_back("--video " + *filter.video_name);
  if (filter.model_name) flags.push_back("--model " + *filter.model_name);
  if (filter.category_name) flags.push_back("--category " + *filter.category_name);
  if (filter.from_s) flags.push_back(fmt::format("--from {:g}", *filter.from_s));
  if (filter.to_s) flags.push_back(fmt::format("--to {:g}", *filter.to_s));
  if (filter.near) flags.emplace_back("--near");
  if (filter.object) flags.push_back(fmt::format("--object {}", *filter.object));
  return fmt::format("{}", fmt::join(flags, ", "));
}

}  // namespace

Expected<std::string> ExplainRejected(SightingFilter filter, IndexStore& store) {
  if (filter.include_rejected) return "";
  filter.include_rejected = true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> matching, store.Objects(filter));
  const auto rejected = std::ranges::count_if(matching, [](const ObjectRecord& one) { return !one.rejected.empty(); });
  if (rejected == 0) return "";
  return fmt::format("{} rejected: --rejected lists {}", CountText(rejected, "object"), rejected == 1 ? "it" : "them");
}

Expected<std::string> ExplainNothingFound(const SightingFilter& filter, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> found, store.Objects(filter));
  if (!found.empty()) return "";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string below, ExplainScores(filter, store));
  if (!below.empty()) return "";
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  if (videos.empty()) return "the index is empty: `victorious index VIDEO` searches a video";
  VICTORIOUS_ASSIGN_OR_RETURN(std::string none_near, ExplainNoObjectNear(filter, store));
  if (!none_near.empty()) return none_near;
  SightingFilter with_rejected = filter;
  with_rejected.include_rejected = true;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> rejected, store.Objects(with_rejected));
  if (rejected.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> all, store.Objects({.include_rejected = true}));
    if (all.empty()) return "no sighting in the index: the search saw none of the models in the videos";
    return fmt::format("no object matches {}; the index has {}", FlagsText(filter), CountText(all.size(), "object"));
  }
  const ObjectRecord& best = *std::ranges::max_element(
      rejected, {}, [](const ObjectRecord& object) { return std::pair(object.score, object.frames); });
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  const auto model = std::ranges::find(models, best.model, &ModelRecord::id);
  return fmt::format("{} rejected (--rejected lists them); the best, {} with score {:.3f} in {}: {}",
                     CountText(rejected.size(), "object"), model == models.end() ? "" : model->name, best.score,
                     CountText(static_cast<std::size_t>(best.frames), "frame"), best.rejected);
}

Expected<std::string> ExplainUnplaced(const SightingFilter& filter, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  std::size_t unplaced = 0;
  std::string reason;
  for (const ObjectRecord& object : objects) {
    if (object.place) continue;
    ++unplaced;
    if (reason.empty()) reason = object.place_rejected;
  }
  if (unplaced == 0) return "";
  return fmt::format("{} of {} no place and {} left out{}", unplaced,
                     CountText(objects.size(), "object") + (unplaced == 1 ? " has" : " have"),
                     unplaced == 1 ? "is" : "are",
                     reason.empty() ? ": the telemetry gives none" : fmt::format("; the first: {}", reason));
}

}  // namespace victorious::cli
