// victorious export --db DB --format FORMAT
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/output_files.h"
#include "victorious/pipeline/drawn_video.h"
#include "victorious/store/export.h"
#include "victorious/store/open_store.h"
#include "victorious/video/video_reader.h"

namespace victorious::cli {
namespace {

constexpr std::string_view kVideoFormat = "video";

// Draws the sightings into a copy of their video.
Status ExportVideo(const std::string& out, const SightingFilter& filter, IndexStore& store, const CLI::App& app) {
  if (out.empty() || out == "-") {
    return Fail(ErrorCode::kInvalidArgument, "--format video: give --out FILE, a name that ends in .mp4 or .mkv");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const IndexedDrawing drawing, ListIndexedDrawing(filter, store));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, {{"--out", out, FileKind::kVideo}}, {drawing.video}));
  VICTORIOUS_RETURN_IF_ERROR(CheckDrawnVideo(out));
  return DrawVideo(drawing.video, drawing.sightings, VideoReaderOptions().folder_frame_rate, out, Interrupt());
}

// Maps hold only objects with a place.
bool IsMap(ExportFormat format) {
  return format == ExportFormat::kGeoJson || format == ExportFormat::kKml || format == ExportFormat::kGpkg;
}

FileKind KindOf(ExportFormat format) {
  switch (format) {
    case ExportFormat::kObjects:
      return FileKind::kObjects;
    case ExportFormat::kSightings:
      return FileKind::kSightings;
    case ExportFormat::kMot:
      return FileKind::kMot;
    case ExportFormat::kCoco:
      return FileKind::kCoco;
    case ExportFormat::kGeoJson:
      return FileKind::kGeoJson;
    case ExportFormat::kKml:
      return FileKind::kKml;
    case ExportFormat::kGpkg:
      break;
  }
  return FileKind::kGeoPackage;
}

}  // namespace

Action SetUpExport(CLI::App& app) {
  struct Arguments {
    std::string db;
    std::string format;
    std::string out;
    FilterArguments filter;
  };
  const auto arguments = std::make_shared<Arguments>();
  AddDb(app, arguments->db);
  app.add_option("--format", arguments->format,
                 "One of " + ExportFormatNames() +
                     " (docs/formats/export.md), or video: a copy of the video with the sightings drawn into it")
      ->required()
      ->type_name("FORMAT");
  app.add_option("--out", arguments->out, "Output file (default: standard output)")->type_name("FILE");
  arguments->filter.AddTo(app);
  AddForce(app);
  return [=, &app]() -> Status {
    if (arguments->format == kVideoFormat) {
      VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
      VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments->db, StoreMode::kRead));
      return ExportVideo(arguments->out, filter, *store, app);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const ExportFormat format, ParseExportFormat(arguments->format));
    VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, {{"--out", arguments->out, KindOf(format)}}));
    VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, arguments->filter.Filter());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(arguments->db, StoreMode::kRead));
    std::ostringstream text;
    VICTORIOUS_RETURN_IF_ERROR(Export(*store, format, filter, text));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string nothing, ExplainNothingFound(filter, *store));
    if (!nothing.empty()) spdlog::info("nothing to export: {}", OneLine(nothing));
    if (IsMap(format)) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::string unplaced, ExplainUnplaced(filter, *store));
      if (!unplaced.empty()) spdlog::info("{}", OneLine(unplaced));
    }
    return WriteOutput(arguments->out, text.view());
  };
}

}  // namespace victorious::cli
