// victorious export --db DB --format FORMAT [--json]; cmd_export_coverage.cc has the format coverage
#include "victorious/apps/cli/cmd_export.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/place/cameras/video_telemetry.h"
#include "victorious/show/drawn_video.h"
#include "victorious/show/export/export.h"
#include "victorious/show/export/export_cot.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

constexpr std::string_view kVideoFormat = "video";
constexpr std::string_view kCoverageFormat = "coverage";

struct ClipArguments {
  std::optional<double> margin_s;
  std::string telemetry;
  std::vector<std::string> files_below;
};

// Prints what was exported to a file: the objects that match the filter, those of them that have a place (a map's), and
// the sightings of both.
Status PrintExported(const std::string& out, std::string_view format, const SightingFilter& filter, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  std::int64_t sightings = 0;
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings(filter, [&](SightingRecord&&) {
    ++sightings;
    return true;
  }));
  const auto placed =
      std::ranges::count_if(objects, [](const ObjectRecord& object) { return object.place.has_value(); });
  const nlohmann::ordered_json line = {{"file", out},
                                       {"format", format},
                                       {"objects", objects.size()},
                                       {"placed_objects", placed},
                                       {"sightings", sightings}};
  return WriteOutput("", DumpJson(line) + "\n");
}

// Draws the sightings into a copy of their video, or into a clip of it.
Status ExportVideo(const std::string& out, const SightingFilter& filter, const ClipArguments& clip, IndexStore& store,
                   const ArgumentParser& parser) {
  constexpr int kTrackFrames = 60;
  if (IsStandardOutput(out)) {
    return Fail(ErrorCode::kInvalidArgument, "--format video: give --out FILE, a name that ends in .mp4 or .mkv");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexedDrawing drawing, ListIndexedDrawing(filter, store));
  const FileRoots roots = RootsOf(clip.files_below);
  VICTORIOUS_RETURN_IF_ERROR(roots.Check(drawing.video));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", out, FileKind::kVideo}}, {drawing.video}));
  VICTORIOUS_RETURN_IF_ERROR(CheckDrawnVideo(out));
  DrawOptions options{.folder_frame_rate = VideoReaderOptions().folder_frame_rate};
  if (!clip.margin_s) {
    VICTORIOUS_RETURN_IF_ERROR(DrawVideo(drawing.video, drawing.sightings, options, out, Interrupt()));
    return {};
  }
  if (drawing.sightings.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(std::string why, ExplainScores(filter, store));
    if (why.empty()) {
      VICTORIOUS_ASSIGN_OR_RETURN(why, ExplainNothingFound(filter, store));
    }
    return Fail(ErrorCode::kNotFound, "--clip: no sighting to show: " + why);
  }
  const std::string table = ClipTelemetryPath(out).string();
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", table, FileKind::kCameraTable}}, {drawing.video}));
  const auto [first, last] = std::ranges::minmax_element(drawing.sightings, {}, &DrawnSighting::time_s);
  options.clip = VideoSpan{.from_s = first->time_s - *clip.margin_s, .to_s = last->time_s + *clip.margin_s};
  options.track_frames = kTrackFrames;
  VICTORIOUS_ASSIGN_OR_RETURN(const VideoSpan span,
                              DrawVideo(drawing.video, drawing.sightings, options, out, Interrupt()));
  const auto warn = [](const std::string& line) { LogWarning(OneLine(line)); };
  const auto file =
      clip.telemetry.empty() ? RememberedTelemetry(drawing.telemetry, roots, warn) : std::optional(clip.telemetry);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::size_t states, WriteClipTelemetry(drawing.video, file, span, out, warn));
  LogInfo("{:.2f} s to {:.2f} s, {}", span.from_s, span.to_s,
          states > 0 ? "with telemetry beside it" : "without telemetry");
  return {};
}

// Says in the log why objects are not in an export that one may expect there.
Status ExplainExport(const ExportFormat& format, const SightingFilter& filter, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string below, ExplainScores(filter, store));
  if (!below.empty()) LogInfo(OneLine(below));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string nothing, ExplainNothingFound(filter, store));
  if (!nothing.empty()) LogInfo("nothing to export: {}", OneLine(nothing));
  if (!format.is_map) return {};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string unplaced, ExplainUnplaced(filter, store));
  if (!unplaced.empty()) LogInfo(OneLine(unplaced));
  return {};
}

}  // namespace

Action SetUpExport(ArgumentParser& parser) {
  struct Arguments {
    std::string db;
    std::string format;
    std::string out;
    FilterArguments filter;
    ClipArguments clip;
    ExportOptions options;
    CoverageArguments coverage;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  AddDb(parser, arguments->db);
  parser
      .Add("--format", arguments->format,
           "One of " + ExportFormatNames() +
               " (docs/formats/export.md), or video: a copy of the video with the sightings drawn into it, or "
               "coverage: how "
               "well the ground was searched")
      .Required()
      .TypeName("FORMAT");
  parser.Add("--out", arguments->out, "Output file (default: standard output, for gpkg unless it is a terminal)")
      .TypeName("FILE");
  arguments->filter.AddTo(parser);
  parser
      .Add("--clip", arguments->clip.margin_s,
           "With --format video: only the part with the sightings, so many seconds before and after, with tracks, and "
           "its telemetry in a table beside it")
      .Range(0.0, 3600.0)
      .TypeName("SECONDS");
  parser
      .Add("--telemetry", arguments->clip.telemetry,
           "With --clip or --format coverage: telemetry of the video (default: as for index)")
      .TypeName("FILE");
  parser
      .Add("--cot-type", arguments->options.cot_type,
           "With --format cot: the type of all events, as a-h-G-E-V (default: of unknown affiliation, by the name)")
      .TypeName("TYPE");
  AddFilesBelow(parser, arguments->clip.files_below);
  AddCoverage(parser, arguments->coverage);
  parser.AddFlag(
      "--json", arguments->json,
      "With --out: print one JSON object: the file, its numbers of objects, of those with a place, of sightings");
  AddForce(parser);
  return [=]() -> Status {
    if (arguments->json && IsStandardOutput(arguments->out)) {
      return Fail(ErrorCode::kInvalidArgument, "--json: says what was written to a file: give --out FILE");
    }
    const bool is_coverage = arguments->format == kCoverageFormat;
    if (!arguments->clip.telemetry.empty() && !arguments->clip.margin_s && !is_coverage) {
      return Fail(ErrorCode::kInvalidArgument, "--telemetry: is for --clip or --format coverage");
    }
    if (!is_coverage) VICTORIOUS_RETURN_IF_ERROR(CheckNoCoverage(arguments->coverage));
    if (is_coverage) {
      return ExportCoverage({.db = arguments->db,
                             .out = arguments->out,
                             .filter = arguments->filter,
                             .coverage = arguments->coverage,
                             .telemetry = arguments->clip.telemetry,
                             .files_below = arguments->clip.files_below,
                             .json = arguments->json},
                            parser);
    }
    if (arguments->format == kVideoFormat) {
      VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
      VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments->db, StoreMode::kRead));
      VICTORIOUS_RETURN_IF_ERROR(CheckObject(filter, *store));
      VICTORIOUS_RETURN_IF_ERROR(ExportVideo(arguments->out, filter, arguments->clip, *store, parser));
      return arguments->json ? PrintExported(arguments->out, arguments->format, filter, *store) : Status();
    }
    if (arguments->clip.margin_s) {
      return Fail(ErrorCode::kInvalidArgument, "--clip: is for --format video, which writes a video");
    }
    const Expected<const ExportFormat*> parsed = FindExportFormat(arguments->format);
    if (!parsed) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}, {}, {}", parsed.error().message, kVideoFormat, kCoverageFormat));
    }
    const ExportFormat& format = **parsed;
    if (!arguments->options.cot_type.empty()) {
      if (&format != &kCotFormat) return Fail(ErrorCode::kInvalidArgument, "--cot-type: is for --format cot");
      VICTORIOUS_RETURN_IF_ERROR(CheckCotType(arguments->options.cot_type));
    }
    VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, {{"--out", arguments->out, &format}}));
    VICTORIOUS_RETURN_IF_ERROR(CheckOutput(arguments->out));
    if (format.is_binary && IsStandardOutput(arguments->out) && ::isatty(STDOUT_FILENO) == 1) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("--format {}: is binary, and not for a terminal: give --out FILE", arguments->format));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments->db, StoreMode::kRead));
    VICTORIOUS_RETURN_IF_ERROR(CheckObject(filter, *store));
    const auto write = [&](std::ostream& out) -> Status {
      VICTORIOUS_RETURN_IF_ERROR(Export(*store, format, filter, out, arguments->options));
      return ExplainExport(format, filter, *store);
    };
    VICTORIOUS_RETURN_IF_ERROR(WriteOutput(arguments->out, write));
    return arguments->json ? PrintExported(arguments->out, arguments->format, filter, *store) : Status();
  };
}

}  // namespace victorious::cli
