// victorious simulate SCENE.json --out DIR [--json]
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/base/json.h"
#include "victorious/base/log.h"
#include "victorious/lab/simulate/simulate.h"

namespace victorious::cli {
namespace {

struct SimulateArguments {
  std::string scene;
  std::string out;
  bool gpu = false;
  bool json = false;
};

Status Run(const SimulateArguments& arguments, const ArgumentParser& parser) {
  std::vector<OutputFile> outputs;
  for (const char* name : {"video.mp4", "telemetry.csv", "truth.jsonl"}) {
    outputs.push_back({"--out", (std::filesystem::path(arguments.out) / name).string(), FileKind::kSimulation});
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, outputs));
  VICTORIOUS_ASSIGN_OR_RETURN(const Scene scene, ReadScene(arguments.scene));
  const auto warn = [](const std::string& warning) { LogWarning(OneLine(warning)); };
  VICTORIOUS_RETURN_IF_ERROR(Simulate(scene, arguments.out, {.software = !arguments.gpu}, Interrupt(), warn));
  if (!arguments.json) return {};
  const nlohmann::ordered_json line = {{"scene", arguments.scene},     {"video", outputs[0].path},
                                       {"telemetry", outputs[1].path}, {"truth", outputs[2].path},
                                       {"frames", scene.video.frames}, {"objects", scene.objects.size()}};
  return WriteOutput("", DumpJson(line) + "\n");
}

}  // namespace

Action SetUpSimulate(ArgumentParser& parser) {
  const auto arguments = std::make_shared<SimulateArguments>();
  parser.Add("SCENE", arguments->scene, "The scene, JSON").Required().TypeName("SCENE.json");
  parser.Add("--out", arguments->out, "Output folder for video.mp4, telemetry.csv and truth.jsonl")
      .Required()
      .TypeName("DIR");
  parser.AddFlag("--gpu", arguments->gpu, "Render on a GPU if there is one: faster, but not pixel-identical");
  parser.AddFlag("--json", arguments->json, "Print one JSON object: the files written, frames, objects");
  AddForce(parser);
  return [=] { return Run(*arguments, parser); };
}

}  // namespace victorious::cli
