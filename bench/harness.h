// How speed is compared: ours and its peers run in turn, in one process, on the same input, and each one's median
// counts. A machine's slow moments then fall on all of them alike.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace victorious::bench {

/// Something to be timed. What it returns is thrown away, but the compiler cannot know that.
struct Contestant {
  std::string name;
  std::function<double()> run;
};

/// How long a comparison may take.
struct Effort {
  double budget_s = 4.0;  ///< for all rounds, once least_rounds are done
  int least_rounds = 5;   ///< so many are timed whatever they take
  int most_rounds = 201;
  double least_time_ms = 1.0;  ///< what is faster is repeated within a round until it takes so long

  /// One round of one run: enough to see that it runs.
  static Effort Quick() { return {.budget_s = 0, .least_rounds = 1, .most_rounds = 1, .least_time_ms = 0}; }
};

/// One line of the report.
struct Result {
  std::string name;
  double median_ms = 0;  ///< ours
  std::vector<std::pair<std::string, double>> peer_median_ms;
  std::vector<std::pair<std::string, double>> figures;  ///< what the input was, and other readings of the median
};

/// Times ours and each peer in turn, round by round. One run of each goes before, untimed.
Result Compare(std::string name, const Contestant& ours, const std::vector<Contestant>& peers, const Effort& effort);

/// {"cascade_0.8": {"median_ms": .., "peers": {"reference": ..}, "ratio_to_reference": .., ...}, ...}; above 1: ours is
/// faster.
nlohmann::ordered_json ToJson(const std::vector<Result>& results);

/// The same, a line a comparison.
std::string ToText(const std::vector<Result>& results);

}  // namespace victorious::bench
