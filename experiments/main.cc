// victorious-experiment NAME --out DIR: repeats a table or figure of the thesis. `victorious experiment` starts it.
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "experiments/experiment.h"
#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/output_files.h"
#include "victorious/apps/cli/run_program.h"

namespace victorious::cli {
namespace {

struct Arguments {
  std::string name;
  std::string out;
  std::string data;
  std::string scenes = "scenes";
  int seeds = 20;
  std::vector<std::string> movies;
  int frames = 0;
};

// A folder that was named must exist. The default one need not: some experiments render their own images.
Expected<std::string> DataFolder(const std::string& given) {
  const char* const set = std::getenv("VICTORIOUS_DATA");
  const std::string named = given.empty() && set != nullptr ? set : given;
  if (named.empty()) return "../shared/data";
  std::error_code error;
  if (!std::filesystem::is_directory(named, error)) {
    return Fail(ErrorCode::kNotFound, fmt::format("{} {}: folder of external data not found",
                                                  given.empty() ? "VICTORIOUS_DATA" : "--data", named));
  }
  return named;
}

// "NAME: summary", one line for each experiment.
std::string Names() {
  std::string text;
  for (const Experiment& experiment : Experiments())
    text += fmt::format("{}: {}\n", experiment.name, experiment.summary);
  return text;
}

Status Run(const Arguments& arguments, const ArgumentParser& parser) {
  if (arguments.name == "list") return WriteOutput("", Names());
  VICTORIOUS_RETURN_IF_ERROR(FindExperiment(arguments.name));
  if (arguments.out.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--out is required: give the output folder for NAME.json, NAME.csv and the plot");
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string data, DataFolder(arguments.data));
  std::vector<OutputFile> outputs;
  for (const char* ending : {".json", ".csv", ".svg"}) {
    const std::filesystem::path path = std::filesystem::path(arguments.out) / (arguments.name + ending);
    outputs.push_back({"--out", path.string(), FileKind::kReport});
  }
  VICTORIOUS_RETURN_IF_ERROR(CheckOutputs(parser, outputs, {data}));
  const ExperimentSettings settings{
      .data = data,
      .scenes = arguments.scenes,
      .out = arguments.out,
      .seeds = arguments.seeds,
      .movies = arguments.movies,
      .frames = arguments.frames,
      .cancel = &Interrupt(),
      .progress = [&](std::string_view what) { fmt::print(stderr, "{}: {}\n", arguments.name, what); }};
  const Expected<Report> report = RunExperiment(arguments.name, settings);
  if (report) return WriteOutput("", ToMarkdown(*report));
  std::error_code error;
  if (report.error().code == ErrorCode::kNotFound && !std::filesystem::is_directory(arguments.scenes, error)) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}; {} is not a folder of scene files: run from the repository's root, or give --scenes",
                            report.error().message, arguments.scenes));
  }
  return std::unexpected(report.error());
}

Expected<int> Main(int argc, char** argv) {
  Arguments arguments;
  ProgramParser parser("victorious experiment", "Repeats a table or figure of the thesis.");
  parser.Add("NAME", arguments.name, "The experiment; list prints these lines\n" + Names()).Required();
  parser.Add("--out", arguments.out, "Output folder for NAME.json, NAME.csv and the plot (required, except for list)")
      .TypeName("DIR");
  parser.Add("--data", arguments.data, "Folder of external data (default $VICTORIOUS_DATA, or ../shared/data)")
      .TypeName("DIR");
  parser.Add("--scenes", arguments.scenes, "Folder of scene files, for experiments that render images (default scenes)")
      .TypeName("DIR");
  parser.Add("--seeds", arguments.seeds, "Random splits to average over (default 20)").Range(1, 10000).TypeName("N");
  parser
      .Add("--movies", arguments.movies,
           "Chapters 4 and 5: the scene files to simulate, by name (default: each experiment's own choice)")
      .SplitAt(',')
      .TypeName("A,B");
  parser
      .Add("--frames", arguments.frames,
           "Largest number of frames per simulated flight, over the same time (default: as in the scene)")
      .Range(2, 1000000)
      .TypeName("N");
  AddForce(parser);
  AddEvents(parser);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<int> ended, ParseArguments(parser, {argv + 1, argv + argc}));
  if (ended) return *ended;
  VICTORIOUS_RETURN_IF_ERROR(Run(arguments, parser));
  return 0;
}

}  // namespace
}  // namespace victorious::cli

int main(int argc, char** argv) { return victorious::cli::RunProgram(argc, argv, &victorious::cli::Main); }
