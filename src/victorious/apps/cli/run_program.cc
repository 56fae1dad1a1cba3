#include "victorious/apps/cli/run_program.h"

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

#include "victorious/apps/cli/arguments.h"
#include "victorious/base/log.h"
#include "victorious/base/one_line.h"
#include "victorious/base/program_events.h"

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
  LogError(OneLine(error.message));
}

Status SendLogToEvents(int descriptor) {
  VICTORIOUS_RETURN_IF_ERROR(OpenEventOutput(descriptor));
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("events", std::make_shared<EventSink>()));
  return {};
}

}  // namespace

void AddEvents(ProgramParser& program) {
  program
      .AddAction("--events", &SendLogToEvents,
                 "Before the command: write log, progress and error as JSON lines to this open file descriptor instead "
                 "of to standard error (docs/formats/events.md)")
      .TypeName("FD");
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

Error StartSiblingProgram(const std::string& name, const std::vector<std::string>& arguments) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).replace_filename(name);
  if (!std::filesystem::exists(program, error)) {
    return {ErrorCode::kNotFound,
            fmt::format("{}: is not there; `make build` builds it from the sources", program.string())};
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
