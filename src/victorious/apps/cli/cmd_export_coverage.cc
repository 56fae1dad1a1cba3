// victorious export --db DB --format coverage --models DIR [--out FILE.tif|FILE.geojson]
#include <filesystem>
#include <memory>
#include <ostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/cli/cmd_export.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/show/coverage_job.h"
#include "victorious/show/export/export_coverage.h"
#include "victorious/show/export/export_map.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

bool IsTiffName(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension();
  return extension == ".tif" || extension == ".tiff";
}

// "jeep: 96 % of the area (1.20 km2) was searched with a probability of at least 0.9".
void LogSummary(const GroundCoverage& coverage, double min_probability) {
  const double area_m2 = AreaOf(coverage);
  const std::string area = area_m2 < 1e5 ? fmt::format("{:.0f} m2", area_m2) : fmt::format("{:.2f} km2", area_m2 / 1e6);
  for (const ModelCoverage& model : coverage.models) {
    LogInfo("{}: {:.0f} % of the area ({}) searched with a probability of at least {}", OneLine(model.model),
            100 * FractionFound(coverage, model, min_probability), area, min_probability);
  }
}

}  // namespace

void AddCoverage(ArgumentParser& parser, CoverageArguments& arguments) {
  parser
      .Add("--models", arguments.models, "With --format coverage: the model library, which has the sizes of the models")
      .TypeName("DIR");
  parser.Add("--params", arguments.params, "With --format coverage: parameters (`victorious params coverage`)")
      .TypeName("FILE");
  AddGround(parser, arguments.ground);
}

Status CheckNoCoverage(const CoverageArguments& arguments) {
  const GroundArguments& ground = arguments.ground;
  const bool has_ground =
      ground.height_m || !ground.terrain.empty() || !ground.vertical_datum.empty() || !ground.geoid_grid.empty();
  if (arguments.models.empty() && arguments.params.empty() && !has_ground) return {};
  return Fail(ErrorCode::kInvalidArgument, "--models, --params, --ground and --terrain are for --format coverage");
}

Status ExportCoverage(const CoverageExport& job, const ArgumentParser& parser) {
  if (job.coverage.models.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--format coverage: give --models DIR, the model library, which has the sizes of the models");
  }
  const bool is_tiff = IsTiffName(job.out);
  VICTORIOUS_RETURN_IF_ERROR(
      CheckOutputs(parser, {{"--out", job.out, is_tiff ? OutputKind(FileKind::kGeoTiff) : &kGeoJsonFormat}}));
  VICTORIOUS_RETURN_IF_ERROR(CheckOutput(job.out));
  VICTORIOUS_ASSIGN_OR_RETURN(const SightingFilter filter, job.filter.Filter());
  CoverageRequest request;
  VICTORIOUS_RETURN_IF_ERROR(ReadParamsFile(job.coverage.params, CollectFields(request.options)));
  request.models = job.coverage.models;
  if (!job.telemetry.empty()) request.telemetry = job.telemetry;
  request.roots = RootsOf(job.files_below);
  request.warn = [](const std::string& line) { LogWarning(OneLine(line)); };
  GroundOptions ground;
  ApplyGround(job.coverage.ground, ground);
  VICTORIOUS_ASSIGN_OR_RETURN(request.ground, MakeGround(ground, request.warn));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<IndexStore> store, OpenStore(job.db, StoreMode::kRead));
  VICTORIOUS_ASSIGN_OR_RETURN(const GroundCoverage coverage, CoverIndex(*store, filter, request, Interrupt()));
  const double min_probability = request.options.min_probability;
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(job.out, [&](std::ostream& out) {
    return is_tiff ? WriteCoverageTiff(coverage, out) : WriteCoverageGeoJson(coverage, min_probability, out);
  }));
  LogSummary(coverage, min_probability);
  if (!job.json) return {};
  Json line = {{"file", job.out}, {"format", "coverage"}};
  line.update(CoverageSummaryJson(coverage, min_probability));
  return WriteOutput("", DumpJson(line) + "\n");
}

}  // namespace victorious::cli
