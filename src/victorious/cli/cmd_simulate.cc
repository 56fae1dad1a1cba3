// victorious simulate SCENE.json --out DIR [--json]
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"
#include "victorious/cli/output_files.h"
#include "victorious/simulate/simulate.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string scene;
  std::string out;
  bool gpu = false;
  bool json = false;
};

Status Run(const Arguments& arguments, const CLI::App& app) {
  std::vector<OutputFile> outputs;
  for (const char* name : {"video.mp4", "telemetry.csv", "truth.jsonl"}) {
    outputs.push_back({"--out", (std::filesystem::path(arguments.out) / name).string(), FileKind::kSimulation});
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(app, outputs));
  VICTORIOUS_ASSIGN_OR_RETURN(const Scene scene, ReadScene(arguments.scene));
  const auto warn = [](const std::string& warning) { spdlog::warn("{}", OneLine(warning)); };
  VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, arguments.out, {.software = !arguments.gpu}, Interrupt(), warn));
  if (!arguments.json) return {};
  const nlohmann::ordered_json line = {{"scene", arguments.scene},     {"video", outputs[0].path},
                                       {"telemetry", outputs[1].path}, {"truth", outputs[2].path},
                                       {"frames", scene.video.frames}, {"objects", scene.objects.size()}};
  return WriteOutput("", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace

Action SetUpSimulate(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("SCENE", arguments->scene, "The scene, JSON")->required()->type_name("SCENE.json");
  app.add_option("--out", arguments->out, "Output folder for video.mp4, telemetry.csv and truth.jsonl")
      ->required()
      ->type_name("DIR");
  app.add_flag("--gpu", arguments->gpu, "Render on a GPU if there is one: faster, but not pixel-identical");
  app.add_flag("--json", arguments->json, "Print one JSON object: the files written, frames, objects");
  AddForce(app);
  return [=, &app] { return Run(*arguments, app); };
}

}  // namespace victorious::cli
