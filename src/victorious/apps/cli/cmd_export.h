// Private to cmd_export*.cc: the format `coverage` of `victorious export`.
#pragma once

#include <string>
#include <vector>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/arguments.h"
#include "victorious/base/error.h"

namespace victorious::cli {

/// The flags of `export --format coverage` alone.
struct CoverageArguments {
  std::string models;
  std::string params;
  GroundArguments ground;
};

void AddCoverage(ArgumentParser& parser, CoverageArguments& arguments);

/// Error: kInvalidArgument if one of the flags was given, for another format.
[[nodiscard]] Status CheckNoCoverage(const CoverageArguments& arguments);

struct CoverageExport {
  std::string db;
  std::string out;
  FilterArguments filter;
  CoverageArguments coverage;
  std::string telemetry;
  std::vector<std::string> files_below;
  bool json = false;
};

/// Writes a GeoTIFF if the name of `out` ends in .tif or .tiff, else GeoJSON, and logs what fraction of the area was
/// searched for each model; with `json` prints it.
[[nodiscard]] Status ExportCoverage(const CoverageExport& job, const ArgumentParser& parser);

}  // namespace victorious::cli
