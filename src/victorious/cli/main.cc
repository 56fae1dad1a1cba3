// The program: a table of commands. Errors are one line on stderr; the exit status is ExitStatus's (base/error.h).
#include <algorithm>
#include <array>
#include <csignal>
#include <exception>
#include <functional>
#include <new>
#include <string_view>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "victorious/base/version.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/command.h"

namespace victorious::cli {
namespace {

constexpr std::array kCommands = {
    Command{"model", "Make", "Make, list, show and remove models of objects", &SetUpModel},
    Command{"frame", "Make", "One frame of a video as a picture, to cut an object out of", &SetUpFrame},
    Command{"category", "Make", "Learn categories from pictures, and say what others show", &SetUpCategory},
    Command{"simulate", "Make", "A flight over a drawn town, with telemetry and truth", &SetUpSimulate},
    Command{"index", "Find", "Find every model in every video, and keep what was found", &SetUpIndex},
    Command{"search", "Find", "The ranked list of what was found, or of moments that look like a picture",
            &SetUpSearch},
    Command{"export", "Find", "What was found, for other programs: objects, sightings, mot, coco", &SetUpExport},
    Command{"track", "Find", "Follow what boxes are drawn around, through this video and others", &SetUpTrack},
    Command{"sheet", "Find", "What was found, as pictures", &SetUpSheet},
    Command{"locate", "Find", "Where on Earth lines of sight meet, and how surely", &SetUpLocate},
    Command{"navigate", "Find", "Where the camera was, by objects in view whose place is known", &SetUpNavigate},
    Command{"match", "Look inside", "Match two pictures, stage by stage", &SetUpMatch},
    Command{"features", "Look inside", "The features of a picture, as text", &SetUpFeatures},
    Command{"telemetry", "Look inside", "The camera's states that a video or a file of telemetry tells",
            &SetUpTelemetry},
    Command{"params", "Look inside", "Every parameter, its default, range and reason", &SetUpParams},
    Command{"doctor", "Look inside", "What this machine offers, or what a file holds", &SetUpDoctor},
    Command{"evaluate", "Measure", "Score an index against ground truth", &SetUpEvaluate},
    Command{"experiment", "Measure", "Repeat a table or figure of the thesis", &SetUpExperiment},
    Command{"bench", "Measure", "The speed of each stage, beside its peers", &SetUpBench},
};

int Fail(const Error& error) {
  spdlog::error("{}", OneLine(error.message));
  return ExitStatus(error.code);
}

int Main(int argc, char** argv) {
  const auto logger = spdlog::stderr_color_mt("victorious");
  logger->set_pattern("%^%l%$: %v");
  spdlog::set_default_logger(logger);

  CLI::App app("Finds your object in hours of video.", "victorious");
  app.set_version_flag("--version", kVersion);
  app.require_subcommand(1);
  app.fallthrough(false);
  Action chosen;
  for (const Command& command : kCommands) {
    CLI::App* subcommand = app.add_subcommand(command.name, command.summary)->group(command.group);
    subcommand->final_callback([&chosen, action = command.setup(*subcommand)] { chosen = action; });
  }
  const auto is_named = [&](const Command& command) { return argc > 1 && std::string_view(command.name) == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && std::ranges::none_of(kCommands, is_named)) {
    return Fail(
        {ErrorCode::kInvalidArgument, fmt::format("{}: no such command; `victorious --help` lists them", argv[1])});
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return Fail(
        {ErrorCode::kInvalidArgument, fmt::format("{} (`victorious {}--help` tells more)", error.what(),
                                                  argc > 1 && argv[1][0] != '-' ? std::string(argv[1]) + " " : "")});
  }
  if (const Status status = chosen(); !status) return Fail(status.error());
  return 0;
}

}  // namespace
}  // namespace victorious::cli

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // beyond `ulimit -f` writing fails, as on a full disk
  try {
    return victorious::cli::Main(argc, argv);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
  }
  return 1;
}
