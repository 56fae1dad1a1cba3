// victorious telemetry FILE [--out FILE.csv] [--json]
#include <memory>
#include <string>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/pipeline/video_telemetry.h"
#include "victorious/telemetry/camera_csv.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string file;
  std::string out;
  std::string params;
  bool json = false;
};

Status Run(const Arguments& arguments) {
  TelemetryOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ReadParams(arguments.params, FieldsOf(options)));
  VICTORIOUS_ASSIGN_OR_RETURN(const Telemetry telemetry, ReadTelemetry(arguments.file, options));
  for (const std::string& warning : telemetry.warnings) {
    spdlog::warn("{}", OneLine(arguments.file + ": " + warning));
  }
  return WriteOutput(arguments.out,
                     arguments.json ? ToJson(telemetry).dump(1) + "\n" : CameraCsvText(telemetry.states));
}

}  // namespace

Action SetUpTelemetry(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("FILE", arguments->file, "A video, KLV, the .SRT of a DJI aircraft, or a table")->required();
  app.add_option("--out", arguments->out, "Where to write; without it, standard output")->type_name("FILE");
  app.add_option("--params", arguments->params, "Parameters as JSON (`victorious params telemetry`)")
      ->type_name("FILE");
  app.add_flag("--json", arguments->json, "Every decoded item, checksum and time stamp, as JSON");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
