// victorious-bench [NAME] [--json] [--quick] [--large] [--cache DIR]: measures the speed of each stage and of whole
// frames against peers. `victorious bench` starts it. Stages run on one core (sift also on two), the search by image,
// data association and the queue on all.
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/benchmarks.h"
#include "bench/harness.h"
#include "victorious/base/error.h"
#include "victorious/base/json.h"
#include "victorious/cli/argument_parser.h"
#include "victorious/cli/run_program.h"

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
                                    Benchmark{"neighbours", &Generated<&BenchNeighbours>},
                                    Benchmark{"device", &BenchDevice},
                                    Benchmark{"cascade", &Generated<&BenchCascade>},
                                    Benchmark{"mlesac", &Generated<&BenchMlesac>},
                                    Benchmark{"frame", &Generated<&BenchFrame>},
                                    Benchmark{"growth", &Generated<&BenchGrowth>},
                                    Benchmark{"index", &BenchIndex},
                                    Benchmark{"search", &Generated<&BenchSearch>},
                                    Benchmark{"locate", &Generated<&BenchLocate>},
                                    Benchmark{"associate", &BenchAssociate},
                                    Benchmark{"track", &Generated<&BenchTrack>},
                                    Benchmark{"queue", &BenchQueue}};

struct Arguments {
  std::string name;  ///< empty: all
  bool json = false;
  Settings settings;
};

void Print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

Status Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  std::vector<Result> results;
  for (const Benchmark& benchmark : kBenchmarks) {
    if (!arguments.name.empty() && benchmark.name != arguments.name) continue;
    const Expected<std::vector<Result>> some = benchmark.run(arguments.settings);
    if (!some && some.error().code == ErrorCode::kUnsupported && arguments.name.empty()) {
      fmt::print(stderr, "{}: left out: {}\n", benchmark.name, some.error().message);
      continue;
    }
    if (!some) return std::unexpected(some.error());
    if (!arguments.json) Print(ToText(*some));
    results.insert(results.end(), some->begin(), some->end());
  }
  if (arguments.json) Print(DumpJson(ToJson(results), 1) + "\n");
  return {};
}

Expected<int> Main(int argc, char** argv) {
  Arguments arguments;
  std::string cache = std::filesystem::temp_directory_path() / "victorious-bench";
  std::vector<std::string> names;
  for (const Benchmark& benchmark : kBenchmarks) names.emplace_back(benchmark.name);
  cli::ProgramParser parser("victorious bench", "Measures the speed of each stage against reference implementations.");
  parser.Add("NAME", arguments.name, "The benchmark (default: all)").OneOf(names);
  parser.AddFlag("--json", arguments.json, "Print JSON");
  parser.AddFlag("--quick", arguments.settings.quick, "Few repetitions, to check that it runs");
  parser.AddFlag("--large", arguments.settings.large,
                 "Of associate: 50,000 objects, whose first fits take half an hour");
  parser
      .Add("--cache", cache,
           "Folder of the models and flights that index makes (default: victorious-bench in the folder of temporary "
           "files)")
      .TypeName("DIR");
  cli::AddEvents(parser);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<int> ended, cli::ParseArguments(parser, {argv + 1, argv + argc}));
  if (ended) return *ended;
  arguments.settings.cache = cache;
  VICTORIOUS_RETURN_IF_ERROR(Run(arguments));
  return 0;
}

}  // namespace
}  // namespace victorious::bench

int main(int argc, char** argv) { return victorious::cli::RunProgram(argc, argv, &victorious::bench::Main); }
