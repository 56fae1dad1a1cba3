// The benchmark harness. Our implementation and its peers run alternately, in one process, on the same input; the
// medians of their times are compared. Disturbances of the machine then affect all of them equally.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace victorious::bench {

/// A function to time. Its result is discarded, but prevents the compiler from removing the computation.
struct Implementation {
  std::string name;
  std::function<double()> run;
};

/// Limits on the duration of a comparison.
struct Effort {
  double budget_s = 4.0;  ///< for all rounds, after min_rounds
  int min_rounds = 5;     ///< rounds timed regardless of budget_s
  int max_rounds = 201;
  double min_time_ms = 1.0;  ///< faster functions are repeated within a round to take at least this long

  /// One round of one call, for smoke tests.
  static Effort Quick() { return {.budget_s = 0, .min_rounds = 1, .max_rounds = 1, .min_time_ms = 0}; }
};

/// One line of the report.
struct Result {
  std::string name;
  double median_ms = 0;  ///< ours
  std::vector<std::pair<std::string, double>> peer_median_ms;
  std::vector<std::pair<std::string, double>> figures;  ///< sizes of the input, and other measurements
};

/// Of the wall clock.
[[nodiscard]] double MillisecondsSince(std::chrono::steady_clock::time_point start);

/// Times our implementation and each peer alternately, round by round. Calls each once before to set the number of
/// repetitions; this call is not counted.
Result Compare(std::string name, const Implementation& ours, const std::vector<Implementation>& peers,
               const Effort& effort);

/// {"cascade_0.8": {"median_ms": .., "peers": {"reference": ..}, "ratio_to_reference": .., ...}, ...}; a ratio
/// above 1 means that ours is faster.
nlohmann::ordered_json ToJson(const std::vector<Result>& results);

/// The same as text, one line per comparison.
std::string ToText(const std::vector<Result>& results);

}  // namespace victorious::bench
