// victorious-bench [NAME] [--json] [--quick] [--large] [--cache DIR]: measures the speed of each stage and of whole
// frames against peers. `victorious bench` starts it. Stages run on one core (sift also on two), the search by image,
// data association and the queue on all.
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "bench/benchmarks.h"
#include "bench/harness.h"
#include "victorious/apps/cli/argument_parser.h"
#include "victorious/apps/cli/run_program.h"
#include "victorious/base/error.h"
#include "victorious/base/json.h"

namespace victorious::bench {
namespace {

struct Benchmark {
  std::string_view name;
  std::string_view measures;
  Expected<std::vector<Result>> (*run)(const Settings&);
};

// A benchmark of generated input, which cannot fail.
template <std::vector<Result> (*Run)(const Settings&)>
Expected<std::vector<Result>> Generated(const Settings& settings) {
  return Run(settings);
}

constexpr auto kBenchmarks = std::to_array<Benchmark>({
    {"sift", "keypoints and descriptors of a frame, beside OpenCV and VLFeat", &Generated<&BenchSift>},
    {"match", "exact nearest descriptors, view by view, beside OpenCV", &Generated<&BenchMatch>},
    {"neighbours", "the four nearest descriptors, beside OpenCV, faiss, hnswlib and FLANN",
     &Generated<&BenchNeighbours>},
    {"device", "exact nearest descriptors on a GPU, beside the processor", &BenchDevice},
    {"cascade", "the cascade of geometric tests, beside its reference", &Generated<&BenchCascade>},
    {"mlesac", "a similarity of matches by MLESAC, beside OpenCV", &Generated<&BenchMlesac>},
    {"frame", "one frame searched for 2 photos, and for 4 models of 253 views", &Generated<&BenchFrame>},
    {"growth", "one frame searched for 1 to 400 models, beside OpenCV", &Generated<&BenchGrowth>},
    {"index", "frames of movies searched for 4 and up to 25 CAD models, by stage, beside OpenCV's SIFT", &BenchIndex},
    {"search", "the search of kept features for an object of an image", &Generated<&BenchSearch>},
    {"locate", "a place from 1000 lines of sight", &Generated<&BenchLocate>},
    {"associate", "data association after one more video", &BenchAssociate},
    {"track", "tracking of regions, and of a box beside OpenCV's trackers", &Generated<&BenchTrack>},
    {"queue", "tasks of a cluster's queue, beside plain commits of PostgreSQL", &BenchQueue},
});

struct Arguments {
  std::string name;  ///< empty: all
  bool json = false;
  std::optional<std::string> cache;
  Settings settings;
};

std::string Describe(std::span<const Benchmark> benchmarks) {
  std::string text = "Measures the speed of each stage against reference implementations:\n";
  for (const Benchmark& benchmark : benchmarks) text += fmt::format("\n  {:<12}{}", benchmark.name, benchmark.measures);
  return text + "\n";
}

// An option that the named benchmark ignores is a mistake.
Status CheckOptions(const Arguments& arguments) {
  const auto check = [&](bool is_given, std::string_view flag, std::string_view name) -> Status {
    if (!is_given || arguments.name.empty() || arguments.name == name) return {};
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: is for the benchmark {}, not for {}", flag, name, arguments.name));
  };
  VICTORIOUS_RETURN_IF_ERROR(check(arguments.settings.large, "--large", "associate"));
  return check(arguments.cache.has_value(), "--cache", "index");
}

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
  std::vector<std::string> names;
  for (const Benchmark& benchmark : kBenchmarks) names.emplace_back(benchmark.name);
  cli::ProgramParser parser("victorious bench", Describe(kBenchmarks));
  parser.Add("NAME", arguments.name, "The benchmark (default: all)").OneOf(names);
  parser.AddFlag("--json", arguments.json, "Print JSON");
  parser.AddFlag("--quick", arguments.settings.quick, "Few repetitions, to check that it runs");
  parser.AddFlag("--large", arguments.settings.large,
                 "Of associate: 50,000 objects, whose first fits take half an hour");
  parser
      .Add("--cache", arguments.cache,
           "Of index: folder of the models and flights that it makes (default: victorious-bench in the folder of "
           "temporary files)")
      .TypeName("DIR");
  cli::AddEvents(parser);
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<int> ended, cli::ParseArguments(parser, {argv + 1, argv + argc}));
  if (ended) return *ended;
  VICTORIOUS_RETURN_IF_ERROR(CheckOptions(arguments));
  arguments.settings.cache = arguments.cache ? std::filesystem::path(*arguments.cache)
                                             : std::filesystem::temp_directory_path() / "victorious-bench";
  VICTORIOUS_RETURN_IF_ERROR(Run(arguments));
  return 0;
}

}  // namespace
}  // namespace victorious::bench

int main(int argc, char** argv) { return victorious::cli::RunProgram(argc, argv, &victorious::bench::Main); }
