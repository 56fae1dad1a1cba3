// Protects the files of the user: a command checks all paths that it will write before it reads or computes anything.
// Three rules: no output is an input of the same command, no two outputs are one file, and an existing file is replaced
// only if it is of the kind that the command writes, or with --force.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/base/error.h"
#include "victorious/show/export/export_format.h"

namespace victorious::cli {

/// The kinds of file that commands write, beside those of `export` (show/export/export_format.h), as identified by the
/// first 64 KiB of their content.
enum class FileKind {
  kImage,            ///< PNG, JPEG, BMP or PNM without EXIF or XMP: a camera's photo has them
  kGeoTiff,          ///< GeoTIFF of `export --format coverage`
  kCameraTable,      ///< CSV with the columns time_s and latitude_deg
  kTelemetryReport,  ///< JSON of `telemetry --json`
  kFeatures,         ///< text of `features`: a first line "N 128"
  kCategoryModel,    ///< a category model or a detector
  kSimulation,       ///< a file in a folder with a truth.jsonl of `simulate`
  kReport,           ///< JSON, CSV or SVG of `experiment`
  kVideo,            ///< a video: never recognised, since a drawn video cannot be told from footage
};

/// A kind of file; std::monostate: the third rule does not apply, because the writer checks the content.
using OutputKind = std::variant<std::monostate, FileKind, const ExportFormat*>;

/// A path that a command will write.
struct OutputFile {
  std::string flag;  ///< the option that names it: "--out"
  std::string path;  ///< empty or "-": standard output, not checked
  OutputKind kind;
};

/// Adds the flag --force to a command that calls CheckOutputs with kinds.
void AddForce(ArgumentParser& command);

/// The telemetry files beside these videos, which a command reads unless `telemetry` names another file: further inputs
/// of CheckOutputs.
[[nodiscard]] std::vector<std::string> ListTelemetryBeside(const std::vector<std::string>& videos,
                                                           const std::optional<std::string>& telemetry);

/// Checks the rules above. The inputs are the values of all options of `command` that name a path, without the options
/// of the outputs, and `further_inputs`. A folder stands for the files directly in it (of --models: the models). Files
/// are the same if they have the same device and inode, or the same path if they do not exist yet: symbolic and hard
/// links are resolved. An empty file, a device and a pipe are of any kind. Errors: kInvalidArgument for a violation;
/// those of reading an existing output.
[[nodiscard]] Status CheckOutputs(const ArgumentParser& command, const std::vector<OutputFile>& outputs,
                                  const std::vector<std::string>& further_inputs = {});

}  // namespace victorious::cli
