#include "victorious/cli/run_program.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "victorious/base/one_line.h"
#include "victorious/base/program_events.h"
#include "victorious/cli/arguments.h"
#include "victorious/cli/suggestion.h"

namespace victorious::cli {
namespace {

// Lines of the log as events.
class EventSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& line) override {
    std::string message(line.payload.data(), line.payload.size());
    if (line.level >= spdlog::level::err) {
      ReportEvent(ErrorEvent{{ErrorCode::kInternal, std::move(message)}});
    } else if (line.level == spdlog::level::warn) {
      ReportEvent(WarningEvent{std::move(message)});
    } else {
      ReportEvent(InfoEvent{std::move(message)});
    }
  }

  void flush_() override {}
};

void ReportError(const Error& error) {
  if (HasEventOutput()) return ReportEvent(ErrorEvent{error});
  spdlog::error("{}", OneLine(error.message));
}

}  // namespace

Status SendLogToEvents(int descriptor) {
  VICTORIOUS_RETURN_IF_ERROR(OpenEventOutput(descriptor));
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("events", std::make_shared<EventSink>()));
  return {};
}

int RunProgram(int argc, char** argv, Expected<int> (*body)(int argc, char** argv)) {
  std::signal(SIGXFSZ, SIG_IGN);                         // beyond `ulimit -f`, writing fails as on a full disk
  const char* const no_color = std::getenv("NO_COLOR");  // https://no-color.org: set and not empty
  const bool plain = no_color != nullptr && *no_color != '\0';
  const auto logger =
      spdlog::stderr_color_mt("victorious", plain ? spdlog::color_mode::never : spdlog::color_mode::automatic);
  logger->set_pattern("%^%l%$: %v");
  spdlog::set_default_logger(logger);
  Expected<int> status = 0;
  try {
    status = body(argc, argv);
  } catch (const std::bad_alloc&) {
    status = Fail(ErrorCode::kInternal, "out of memory");
  } catch (const std::exception& error) {
    status = Fail(ErrorCode::kInternal, error.what());
  }
  if (status) return *status;
  ReportError(status.error());
  constexpr int kEndedBySignal = 128;  // a shell's convention
  if (status.error().code == ErrorCode::kCancelled && InterruptSignal() != 0) return kEndedBySignal + InterruptSignal();
  return ExitStatus(status.error().code);
}

namespace {

// The commands that were parsed, outermost first.
std::vector<CLI::App*> ParsedCommands(CLI::App& app) {
  std::vector<CLI::App*> commands = {&app};
  while (!commands.back()->get_subcommands().empty()) commands.push_back(commands.back()->get_subcommands().front());
  return commands;
}

// The names that a word of the innermost command can be: its options, or its subcommands.
std::vector<std::string> KnownNames(const CLI::App& command, bool options) {
  std::vector<std::string> names;
  if (!options) {
    for (const CLI::App* part : command.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(part->get_name());
    return names;
  }
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// "; did you mean --models?" for the first word that the parser did not expect; empty if none is near a known name.
std::string Suggestion(CLI::App& app) {
  for (const CLI::App* command : ParsedCommands(app)) {
    for (const std::string& word : command->remaining()) {
      const auto nearest = FindNearest(word, KnownNames(*command, word.starts_with('-')));
      if (nearest) return fmt::format("; {}: did you mean {}?", word, *nearest);
    }
  }
  return "";
}

// "--every 2.5: give a whole number" for CLI11's "Could not convert: --every = 2.5".
std::optional<std::string> ExplainConversion(CLI::App& app, std::string_view message) {
  constexpr std::string_view kStart = "Could not convert: ";
  constexpr std::string_view kBetween = " = ";
  if (!message.starts_with(kStart)) return std::nullopt;
  message.remove_prefix(kStart.size());
  const std::size_t between = message.find(kBetween);
  if (between == std::string_view::npos) return std::nullopt;
  const std::string name(message.substr(0, between));
  const CLI::Option* option = ParsedCommands(app).back()->get_option_no_throw(name);
  const bool whole = option != nullptr && option->get_type_name() == "N";
  // Counts and intervals, from 1; frame numbers, seeds and --threads start at 0.
  constexpr std::array<std::string_view, 6> kCountOptions = {"--every",   "--most",       "--columns",
                                                             "--moments", "--directions", "--frames"};
  const bool is_count = std::ranges::find(kCountOptions, name) != kCountOptions.end();
  return fmt::format("{} {}: give a {}number{}", name, message.substr(between + kBetween.size()), whole ? "whole " : "",
                     is_count ? " from 1" : "");
}

}  // namespace

Expected<std::optional<int>> ParseArguments(CLI::App& app, int argc, char** argv, const std::string& name) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    const std::string what = ExplainConversion(app, error.what()).value_or(error.what());
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}{} (see `{} --help`)", what, Suggestion(app), name));
  }
  return std::nullopt;
}

Error StartSiblingProgram(const std::string& name, const std::vector<std::string>& arguments) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).replace_filename(name);
  if (!std::filesystem::exists(program, error)) {
    return {ErrorCode::kNotFound, fmt::format("{}: is not built; `make build` builds it", program.string())};
  }
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  return ErrorFromErrno(errno, fmt::format("start {}", program.string()));
}

}  // namespace victorious::cli
