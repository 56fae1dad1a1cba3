// The program: dispatches to a table of commands. An error is one line on stderr; ExitStatus (base/error.h) gives the
// exit status.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>

#include "victorious/base/version.h"
#include "victorious/cli/command.h"
#include "victorious/cli/run_program.h"
#include "victorious/cli/suggestion.h"

namespace victorious::cli {
namespace {

// Of a command that computes in parallel and leaves the number of threads to the library. `index` and `work` have a
// flag of their own, which also applies to decoding.
constexpr bool kHasThreads = true;

constexpr std::array kCommands = {
    Command{"model", "Make", "Make, list, show and remove models of objects", &SetUpModel, kHasThreads},
    Command{"frame", "Make", "Write one frame of a video as an image, to cut an object out", &SetUpFrame},
    Command{"copy", "Make", "Write a copy of a video that browsers play, every frame at its time", &SetUpCopy},
    Command{"category", "Make", "Train categories from images, and classify images", &SetUpCategory, kHasThreads},
    Command{"simulate", "Make", "Render a flight over a scene, with telemetry and ground truth", &SetUpSimulate,
            kHasThreads},
    Command{"index", "Find", "Find every model in every video, and store the results", &SetUpIndex},
    Command{"search", "Find", "List the objects found, ranked, or the moments similar to an image", &SetUpSearch,
            kHasThreads},
    Command{"export", "Find", "Export the results as JSON, map or annotation files", &SetUpExport},
    Command{"track", "Find", "Track the objects in user boxes through one or more videos", &SetUpTrack, kHasThreads},
    Command{"serve", "Find", "Show the results in the browser: ranked list, video and map", &SetUpServe},
    Command{"user", "Find", "Say who may use `serve`: accounts, roles, tokens, log", &SetUpUser},
    Command{"sheet", "Find", "Draw the objects found on a contact sheet", &SetUpSheet},
    Command{"locate", "Find", "Locate the intersection of lines of sight, with covariance", &SetUpLocate},
    Command{"navigate", "Find", "Estimate the camera pose from landmarks of known place", &SetUpNavigate, kHasThreads},
    Command{"submit", "Cluster", "Give videos to workers that share a PostgreSQL database", &SetUpSubmit},
    Command{"work", "Cluster", "Index submitted videos, one after the other", &SetUpWork},
    Command{"cluster", "Cluster", "List the tasks of the workers and their progress", &SetUpCluster},
    Command{"match", "Look inside", "Match two images, stage by stage", &SetUpMatch, kHasThreads},
    Command{"features", "Look inside", "Print the features of an image as text", &SetUpFeatures, kHasThreads},
    Command{"telemetry", "Look inside", "Print the camera states of a video or telemetry file", &SetUpTelemetry},
    Command{"params", "Look inside", "List every parameter with default, range and reason", &SetUpParams},
    Command{"doctor", "Look inside", "Describe this machine, or the content of a file", &SetUpDoctor},
    Command{"manual", "Look inside", "Print the manual page, or the completion for bash", &SetUpManual},
    Command{"evaluate", "Measure", "Score an index against ground truth", &SetUpEvaluate},
    Command{"experiment", "Measure", "Reproduce a table or figure of the thesis", nullptr, false,
            "victorious-experiment"},
    Command{"bench", "Measure", "Measure the speed of each stage against reference implementations", nullptr, false,
            "victorious-bench"},
};

// Adds --events to the program. It takes effect before the rest of the command line is parsed: an error there is an
// event as well.
void AddEvents(CLI::App& app) {
  app.add_option_function<int>(
         "--events",
         [](int descriptor) {
           const Status status = SendLogToEvents(descriptor);
           if (!status) throw CLI::ValidationError("--events", status.error().message);
         },
         "Before the command: write log, progress and error as JSON lines to this open file descriptor instead of to "
         "standard error (docs/formats/events.md)")
      ->type_name("FD")
      ->trigger_on_parse();
}

// Adds --threads to a command, or to its parts.
void AddThreads(CLI::App& command, int& threads) {
  const std::vector<CLI::App*> parts = command.get_subcommands([](const CLI::App*) { return true; });
  for (CLI::App* part : parts) {
    const bool computes = part->get_name() != "list" && part->get_name() != "remove";
    if (computes) AddThreads(*part, threads);
  }
  if (!parts.empty()) return;
  command.add_option("--threads", threads, "Number of threads that compute; 0: one per processor")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
}

Expected<int> Main(int argc, char** argv) {
  const auto is_named = [&](const Command& command) { return argc > 1 && std::string_view(command.name) == argv[1]; };
  const auto named = std::ranges::find_if(kCommands, is_named);
  if (named != kCommands.end() && named->program != nullptr) {
    return std::unexpected(StartSiblingProgram(named->program, {argv + 2, argv + argc}));
  }
  CLI::App app("Finds your object in hours of video.", "victorious");
  app.set_version_flag("-V,--version", kVersion);
  AddEvents(app);
  app.require_subcommand(1);
  app.fallthrough(false);
  Action chosen;
  int threads = 0;
  for (const Command& command : kCommands) {
    CLI::App* subcommand = app.add_subcommand(command.name, command.summary)->group(command.group);
    if (command.setup == nullptr) continue;
    subcommand->final_callback([&chosen, action = command.setup(*subcommand)] { chosen = action; });
    if (command.has_threads) AddThreads(*subcommand, threads);
  }
  const bool is_command = argc > 1 && argv[1][0] != '-';
  if (is_command && named == kCommands.end()) {
    std::vector<std::string> names;
    for (const Command& command : kCommands) names.emplace_back(command.name);
    const auto nearest = FindNearest(argv[1], names);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: unknown command{}; `victorious --help` lists the commands", argv[1],
                            nearest ? fmt::format(": did you mean {}?", *nearest) : ""));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::optional<int> ended,
      ParseArguments(app, argc, argv, is_command ? fmt::format("victorious {}", argv[1]) : "victorious"));
  if (ended) return *ended;
  if (!chosen) {
    return Fail(ErrorCode::kInvalidArgument, "give the command first; `victorious --help` lists the commands");
  }
  std::optional<oneapi::tbb::global_control> limit;
  if (threads > 0) {
    limit.emplace(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    cv::setNumThreads(threads);
  }
  VICTORIOUS_RETURN_IF_ERROR(chosen());
  return 0;
}

}  // namespace
}  // namespace victorious::cli

int main(int argc, char** argv) { return victorious::cli::RunProgram(argc, argv, &victorious::cli::Main); }
