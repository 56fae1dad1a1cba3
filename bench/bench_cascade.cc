#include <fmt/format.h>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/search/grammar/cascade.h"

namespace victorious::bench {
namespace {

Result CompareWithDefinition(double ratio, std::size_t true_matches, std::size_t false_matches,
                             const Settings& settings) {
  const MatchedScene drawn = SimulateMatches(true_matches, false_matches, /*seed=*/1);
  const auto by = [&](const char* name, auto* filter) {
    return Implementation{
        name,
        [&, filter] { return static_cast<double>(filter(drawn.scene, drawn.model, drawn.matches, {}).third.size()); }};
  };
  Result result = Compare(fmt::format("cascade_{:g}", ratio), by("victorious", &FilterByGrammar),
                          {by("reference", &FilterByGrammarRef)}, settings.effort());
  const CascadeResult left = FilterByGrammar(drawn.scene, drawn.model, drawn.matches, {});
  result.figures = {{"keypoints", static_cast<double>(drawn.scene.size())},
                    {"matches", static_cast<double>(drawn.matches.size())},
                    {"true", static_cast<double>(true_matches)},
                    {"first", static_cast<double>(left.first.size())},
                    {"second", static_cast<double>(left.second.size())},
                    {"third", static_cast<double>(left.third.size())}};
  return result;
}

}  // namespace

std::vector<Result> BenchCascade(const Settings& settings) {
  return {CompareWithDefinition(0.8, 12, 68, settings), CompareWithDefinition(0.95, 13, 607, settings)};
}

}  // namespace victorious::bench
