#include "victorious/cli/run_program.h"

#include <cerrno>
#include <csignal>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "victorious/cli/arguments.h"

namespace victorious::cli {
int RunProgram(int argc, char** argv, Expected<int> (*body)(int argc, char** argv)) {
  std::signal(SIGXFSZ, SIG_IGN);  // beyond `ulimit -f`, writing fails as on a full disk
  try {
    const auto logger = spdlog::stderr_color_mt("victorious");
    logger->set_pattern("%^%l%$: %v");
    spdlog::set_default_logger(logger);
    const Expected<int> status = body(argc, argv);
    if (status) return *status;
    spdlog::error("{}", OneLine(status.error().message));
    return ExitStatus(status.error().code);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
  }
  return 1;
}

Expected<std::optional<int>> ParseArguments(CLI::App& app, int argc, char** argv, const std::string& name) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} (see `{} --help`)", error.what(), name));
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
