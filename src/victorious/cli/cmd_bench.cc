// victorious bench [NAME]: starts victorious-bench, a separate program in the same folder
#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "victorious/cli/command.h"

namespace victorious::cli {

Action SetUpBench(CLI::App& app) {
  struct Arguments {
    std::string name;
    bool json = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  app.add_option("NAME", arguments->name,
                 "One benchmark: sift, match, cascade, mlesac, frame, search, locate (default: all)");
  app.add_flag("--json", arguments->json, "Print medians, and the ratio to every reference as ratio_to_<peer>");
  return [=]() -> Status {
    std::error_code error;
    const std::filesystem::path program =
        std::filesystem::read_symlink("/proc/self/exe", error).replace_filename("victorious-bench");
    if (!std::filesystem::exists(program, error)) {
      return Fail(ErrorCode::kNotFound,
                  fmt::format("{}: not found: build the benchmarks with `make build`", program.string()));
    }
    std::vector<std::string> words = {program.string()};
    if (!arguments->name.empty()) words.push_back(arguments->name);
    if (arguments->json) words.emplace_back("--json");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::execv(program.c_str(), argv.data());
    return std::unexpected(ErrorFromErrno(errno, fmt::format("start {}", program.string())));
  };
}

}  // namespace victorious::cli
