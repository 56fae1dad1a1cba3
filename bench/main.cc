// victorious-bench [NAME] [--json] [--quick]: measures the speed of each stage and of whole frames against peers.
// `victorious bench` starts it. Stages run on one core (sift also on two), the search by image on all cores.
#include <algorithm>
#include <array>
#include <cstdio>
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
  std::vector<Result> (*run)(const Settings&);
};

constexpr std::array kBenchmarks = {Benchmark{"sift", &BenchSift},       Benchmark{"match", &BenchMatch},
                                    Benchmark{"cascade", &BenchCascade}, Benchmark{"mlesac", &BenchMlesac},
                                    Benchmark{"frame", &BenchFrame},     Benchmark{"search", &BenchSearch},
                                    Benchmark{"locate", &BenchLocate},   Benchmark{"track", &BenchTrack}};

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
  for (const std::string_view word : std::vector<std::string_view>(argv + 1, argv + argc)) {
    const bool known = std::ranges::any_of(kBenchmarks, [&](const Benchmark& one) { return one.name == word; });
    if (word == "--help" || word == "-h") {
      arguments.help = true;
    } else if (word == "--json") {
      arguments.json = true;
    } else if (word == "--quick") {
      arguments.settings.quick = true;
    } else if (known && arguments.name.empty()) {
      arguments.name = word;
    } else {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: give at most one benchmark ({}), --json, --quick", word, Names()));
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
      "  NAME        One of {} (default: all)\n"
      "  -h,--help   Print this help message and exit\n"
      "  --json      Print JSON\n"
      "  --quick     Few repetitions, to check that it runs\n",
      Names());
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  std::vector<Result> results;
  for (const Benchmark& benchmark : kBenchmarks) {
    if (!arguments.name.empty() && benchmark.name != arguments.name) continue;
    const std::vector<Result> some = benchmark.run(arguments.settings);
    if (!arguments.json) Print(ToText(some));
    results.insert(results.end(), some.begin(), some.end());
  }
  if (arguments.json) Print(ToJson(results).dump(1) + "\n");
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
  victorious::bench::Run(*arguments);
}
