// victorious-bench [NAME] [--json] [--quick] [--cache DIR]: measures the speed of each stage and of whole frames
// against peers. `victorious bench` starts it. Stages run on one core (sift also on two), the search by image on all.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/benchmarks.h"
#include "bench/harness.h"
#include "victorious/base/error.h"

namespace victorious::bench {
namespace {

struct Benchmark {
  std::string_view name;
  Expected<std::vector<Result>> (*run)(const Settings&);
};

// A benchmark of generated input, which cannot fail.
template <std::vector<Result> (*Run)(const Settings&)>
Expected<std::vector<Result>> Generated(const Settings& settings) {
  return Run(settings);
}

constexpr std::array kBenchmarks = {Benchmark{"sift", &Generated<&BenchSift>},
                                    Benchmark{"match", &Generated<&BenchMatch>},
                                    Benchmark{"cascade", &Generated<&BenchCascade>},
                                    Benchmark{"mlesac", &Generated<&BenchMlesac>},
                                    Benchmark{"frame", &Generated<&BenchFrame>},
                                    Benchmark{"growth", &Generated<&BenchGrowth>},
                                    Benchmark{"index", &BenchIndex},
                                    Benchmark{"search", &Generated<&BenchSearch>},
                                    Benchmark{"locate", &Generated<&BenchLocate>},
                                    Benchmark{"track", &Generated<&BenchTrack>}};

struct Arguments {
  std::string name;  ///< empty: all
  bool help = false;
  bool json = false;
  Settings settings;
};

std::string Names() {
  std::string names;
  for (const Benchmark& benchmark : kBenchmarks)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", benchmark.name);
  return names;
}

Expected<Arguments> Parse(int argc, char** argv) {
  Arguments arguments;
  arguments.settings.cache = std::filesystem::temp_directory_path() / "victorious-bench";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool known = std::ranges::any_of(kBenchmarks, [&](const Benchmark& one) { return one.name == word; });
    if (word == "--help" || word == "-h") {
      arguments.help = true;
    } else if (word == "--json") {
      arguments.json = true;
    } else if (word == "--quick") {
      arguments.settings.quick = true;
    } else if (word == "--cache" && i + 1 < argc) {
      arguments.settings.cache = argv[++i];
    } else if (known && arguments.name.empty()) {
      arguments.name = word;
    } else {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: give at most one benchmark ({}), --json, --quick, --cache DIR", word, Names()));
    }
  }
  return arguments;
}

void Print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

std::string Help() {
  return fmt::format(
      "Measures the speed of each stage against reference implementations.\n"
      "Usage: victorious bench [NAME] [OPTIONS]\n\n"
      "  NAME         One of {} (default: all)\n"
      "  -h,--help    Print this help message and exit\n"
      "  --json       Print JSON\n"
      "  --quick      Few repetitions, to check that it runs\n"
      "  --cache DIR  Folder of the models and flights that index makes (default: victorious-bench in the folder of "
      "temporary files)\n",
      Names());
}

Status Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  std::vector<Result> results;
  for (const Benchmark& benchmark : kBenchmarks) {
    if (!arguments.name.empty() && benchmark.name != arguments.name) continue;
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<Result> some, benchmark.run(arguments.settings));
    if (!arguments.json) Print(ToText(some));
    results.insert(results.end(), some.begin(), some.end());
  }
  if (arguments.json) Print(ToJson(results).dump(1) + "\n");
  return {};
}

}  // namespace
}  // namespace victorious::bench

int main(int argc, char** argv) {
  const auto arguments = victorious::bench::Parse(argc, argv);
  if (!arguments) {
    fmt::print(stderr, "error: {}\n", arguments.error().message);
    return victorious::ExitStatus(arguments.error().code);
  }
  if (arguments->help) {
    victorious::bench::Print(victorious::bench::Help());
    return 0;
  }
  if (const victorious::Status done = victorious::bench::Run(*arguments); !done) {
    fmt::print(stderr, "error: {}\n", done.error().message);
    return victorious::ExitStatus(done.error().code);
  }
}
