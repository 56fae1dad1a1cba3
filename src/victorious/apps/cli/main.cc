// The program: dispatches to a table of commands. An error is one line on stderr; ExitStatus (base/error.h) gives the
// exit status.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <opencv2/core/utility.hpp>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/run_program.h"
#include "victorious/base/error.h"
#include "victorious/base/suggestion.h"
#include "victorious/base/version.h"
#include "victorious/input/video/trusted_certificates.h"

namespace victorious::cli {
namespace {

// Of a command that computes in parallel and leaves the number of threads to the library. `index` and `work` have a
// flag of their own, which also applies to decoding.
constexpr bool kHasThreads = true;

// Of a command that opens live sources or other addresses, by itself or by processes that it starts.
constexpr bool kHasAddresses = true;

constexpr std::array kCommands = {
    Command{"model", "Make", "Make, list, show and remove models of objects", &SetUpModel, kHasThreads},
    Command{"frame", "Make", "Write one frame of a video as an image, to cut an object out", &SetUpFrame, !kHasThreads,
            nullptr, kHasAddresses},
    Command{"copy", "Make", "Write a copy of a video that browsers play, every frame at its time", &SetUpCopy,
            !kHasThreads, nullptr, kHasAddresses},
    Command{"category", "Make", "Train categories from images, and classify images", &SetUpCategory, kHasThreads},
    Command{"simulate", "Make", "Render a flight over a scene, with telemetry and ground truth", &SetUpSimulate,
            kHasThreads},
    Command{"index", "Find", "Find every model in every video, and store the results", &SetUpIndex, !kHasThreads,
            nullptr, kHasAddresses},
    Command{"search", "Find", "List the objects found, ranked, or the moments similar to an image", &SetUpSearch,
            kHasThreads},
    Command{"export", "Find", "Export the results as JSON, map or annotation files", &SetUpExport},
    Command{"track", "Find", "Track the objects in user boxes through one or more videos", &SetUpTrack, kHasThreads,
            nullptr, kHasAddresses},
    Command{"serve", "Find", "Show the results in the browser: ranked list, video and map", &SetUpServe, !kHasThreads,
            nullptr, kHasAddresses},
    Command{"object", "Find", "Correct which moments are one object: join objects, or split one", &SetUpObject},
    Command{"user", "Find", "Say who may use `serve`: accounts, roles, tokens, log", &SetUpUser},
    Command{"remove", "Find", "Take a video or a model out of an index, with all that was found of it", &SetUpRemove},
    Command{"backup", "Find", "Copy an index while it is read and written", &SetUpBackup},
    Command{"sheet", "Find", "Draw the objects found on a contact sheet", &SetUpSheet},
    Command{"locate", "Find", "Locate the intersection of lines of sight, with covariance", &SetUpLocate},
    Command{"navigate", "Find", "Estimate the camera pose from landmarks of known place", &SetUpNavigate, kHasThreads,
            nullptr, kHasAddresses},
    Command{"submit", "Cluster", "Give videos and live sources to workers that share a PostgreSQL database",
            &SetUpSubmit, !kHasThreads, nullptr, kHasAddresses},
    Command{"work", "Cluster", "Index submitted videos, one after the other", &SetUpWork, !kHasThreads, nullptr,
            kHasAddresses},
    Command{"cluster", "Cluster", "List the tasks of the workers and their progress; end live sources", &SetUpCluster},
    Command{"record", "Cluster", "Record a live source into files, as it comes", &SetUpRecord, !kHasThreads, nullptr,
            kHasAddresses},
    Command{"match", "Look inside", "Match two images, stage by stage", &SetUpMatch, kHasThreads},
    Command{"features", "Look inside", "Print the features of an image as text", &SetUpFeatures, kHasThreads},
    Command{"telemetry", "Look inside", "Print the camera states of a video or telemetry file", &SetUpTelemetry,
            !kHasThreads, nullptr, kHasAddresses},
    Command{"params", "Look inside", "List every parameter with default, range and reason", &SetUpParams},
    Command{"doctor", "Look inside", "Describe this machine, or the content of a file", &SetUpDoctor, !kHasThreads,
            nullptr, kHasAddresses},
    Command{"self-test", "Look inside",
            "Check that this machine can do all of it: draws a short flight, and finds an object in it",
            &SetUpSelfTest},
    Command{"manual", "Look inside", "Print the manual page, or the completion for a shell", &SetUpManual},
    Command{"evaluate", "Measure", "Score an index against ground truth", &SetUpEvaluate},
    Command{"experiment", "Measure", "Reproduce a table or figure of the thesis", nullptr, false,
            "victorious-experiment"},
    Command{"bench", "Measure", "Measure the speed of each stage against reference implementations", nullptr, false,
            "victorious-bench"},
};

// Adds --threads to a command, or to its parts.
void AddThreads(ArgumentParser& command, int& threads) {
  std::vector<ArgumentParser> parts = command.Commands();
  for (ArgumentParser& part : parts) {
    const bool computes = part.Name() != "list" && part.Name() != "remove";
    if (computes) AddThreads(part, threads);
  }
  if (!parts.empty()) return;
  command.Add("--threads", threads, "Number of threads that compute; 0: one per processor")
      .Range(0, 1024)
      .TypeName("N");
}

void AddCertificates(ArgumentParser& command, std::string& file) {
  command
      .Add("--ca", file,
           "Certificates (PEM) of the authorities that the servers of encrypted addresses (rtsps, https, rtmps) are "
           "verified by (default: those of the system)")
      .TypeName("FILE");
}

// The words of the command line.
struct CommandLine {
  std::vector<std::string> events;  // --events and its descriptor
  std::vector<std::string> rest;    // the command with its arguments, or other options of the program
};

CommandLine SplitCommandLine(int argc, char** argv) {
  char** word = argv + 1;
  char** const end = argv + argc;
  while (word != end && std::string_view(*word).starts_with("--events")) {
    const bool is_followed = std::string_view(*word) == "--events" && word + 1 != end;  // else --events=FD
    word += is_followed ? 2 : 1;
  }
  CommandLine line{.events = {argv + 1, word}, .rest = {word, end}};
  if (!line.rest.empty() && line.rest.front() == "help") {  // "help COMMAND" is "COMMAND --help"
    line.rest.erase(line.rest.begin());
    line.rest.emplace_back("--help");
  }
  return line;
}

// Starts the command if it is a program of its own. Returns why it does not start, or that there is no such command;
// std::nullopt for the commands of this program and for options.
std::optional<Error> StartOrCheckCommand(const CommandLine& line) {
  if (line.rest.empty() || line.rest.front().starts_with('-')) return std::nullopt;
  const std::string& name = line.rest.front();
  const auto named = std::ranges::find(kCommands, name, &Command::name);
  if (named == kCommands.end()) {
    std::vector<std::string> names;
    for (const Command& command : kCommands) names.emplace_back(command.name);
    const auto nearest = FindNearest(name, names);
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: unknown command{}; `victorious --help` lists the commands", name,
                             nearest ? fmt::format(": did you mean {}?", *nearest) : "")};
  }
  if (named->program == nullptr) return std::nullopt;
  std::vector<std::string> arguments = line.events;
  arguments.insert(arguments.end(), line.rest.begin() + 1, line.rest.end());
  return StartSiblingProgram(named->program, arguments);
}

Expected<int> Main(int argc, char** argv) {
  const CommandLine line = SplitCommandLine(argc, argv);
  const std::optional<Error> error = StartOrCheckCommand(line);
  ProgramParser program("victorious", "Finds your object in hours of video.", kVersion);
  AddEvents(program);
  VICTORIOUS_RETURN_IF_ERROR(ParseArguments(program, line.events));  // from here on each error is an event
  if (error) return std::unexpected(*error);
  program.RequireCommand();
  int threads = 0;
  std::string certificates;
  std::vector<std::pair<ArgumentParser, Action>> actions;
  for (const Command& command : kCommands) {
    ArgumentParser parser = program.AddCommand(command.name, command.summary, command.group);
    if (command.setup == nullptr) continue;
    actions.emplace_back(parser, command.setup(parser));
    if (command.has_threads) AddThreads(parser, threads);
    if (command.has_addresses) AddCertificates(parser, certificates);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<int> ended, ParseArguments(program, line.rest));
  if (ended) return *ended;
  const auto chosen = std::ranges::find_if(actions, [](const auto& one) { return one.first.IsGiven(); });
  if (chosen == actions.end()) {
    return Fail(ErrorCode::kInvalidArgument, "give the command first; `victorious --help` lists the commands");
  }
  std::optional<oneapi::tbb::global_control> limit;
  if (threads > 0) {
    limit.emplace(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    cv::setNumThreads(threads);
  }
  if (!certificates.empty()) VICTORIOUS_RETURN_IF_ERROR(TrustCertificates(certificates));
  VICTORIOUS_RETURN_IF_ERROR(chosen->second());
  return 0;
}

}  // namespace
}  // namespace victorious::cli

int main(int argc, char** argv) { return victorious::cli::RunProgram(argc, argv, &victorious::cli::Main); }
