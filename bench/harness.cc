#include "bench/harness.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace victorious::bench {
namespace {

using Clock = std::chrono::steady_clock;

// The mean time of `repetitions` calls.
double TimeMs(const Implementation& implementation, int repetitions) {
  volatile double sink = 0;
  const Clock::time_point start = Clock::now();
  for (int i = 0; i < repetitions; ++i) sink = sink + implementation.run();
  return MillisecondsSince(start) / repetitions;
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

// Formats as us, ms or s, whichever has a value of at least 1.
std::string TimeText(double ms) {
  if (ms < 1) return fmt::format("{:.2f} us", 1000 * ms);
  if (ms < 1000) return fmt::format("{:.2f} ms", ms);
  return fmt::format("{:.2f} s", ms / 1000);
}

}  // namespace

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Result Compare(std::string name, const Implementation& ours, const std::vector<Implementation>& peers,
               const Effort& effort) {
  std::vector<const Implementation*> implementations = {&ours};
  for (const Implementation& peer : peers) implementations.push_back(&peer);
  std::vector<int> repetitions;
  for (const Implementation* implementation : implementations) {
    const double once_ms = std::max(1e-6, TimeMs(*implementation, 1));
    repetitions.push_back(std::max(1, static_cast<int>(std::ceil(effort.min_time_ms / once_ms))));
  }
  std::vector<std::vector<double>> times_ms(implementations.size());
  const Clock::time_point start = Clock::now();
  for (int round = 0; round < effort.max_rounds; ++round) {
    if (round >= effort.min_rounds && MillisecondsSince(start) > 1000 * effort.budget_s) break;
    for (std::size_t c = 0; c < implementations.size(); ++c) {
      times_ms[c].push_back(TimeMs(*implementations[c], repetitions[c]));
    }
  }
  Result result{.name = std::move(name), .median_ms = Median(times_ms[0]), .peer_median_ms = {}, .figures = {}};
  for (std::size_t p = 0; p < peers.size(); ++p) {
    result.peer_median_ms.emplace_back(peers[p].name, Median(times_ms[p + 1]));
  }
  return result;
}

nlohmann::ordered_json ToJson(const std::vector<Result>& results) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const Result& result : results) {
    nlohmann::ordered_json& entry = json[result.name];
    entry["median_ms"] = result.median_ms;
    entry["peers"] = nlohmann::ordered_json::object();
    for (const auto& [peer, median_ms] : result.peer_median_ms) entry["peers"][peer] = median_ms;
    for (const auto& [peer, median_ms] : result.peer_median_ms) {
      entry["ratio_to_" + peer] = median_ms / result.median_ms;
    }
    for (const auto& [figure, value] : result.figures) entry[figure] = value;
  }
  return json;
}

std::string ToText(const std::vector<Result>& results) {
  std::string text;
  for (const Result& result : results) {
    text += fmt::format("{:<16} {:>11}", result.name, TimeText(result.median_ms));
    for (const auto& [peer, median_ms] : result.peer_median_ms) {
      text += fmt::format("   {} {} ({:.2f} x)", peer, TimeText(median_ms), median_ms / result.median_ms);
    }
    for (std::size_t f = 0; f < result.figures.size(); ++f) {
      const auto& [figure, value] = result.figures[f];
      text += fmt::format("{}{} {:.6g}", f == 0 ? "   # " : ", ", figure, value);
    }
    text += "\n";
  }
  return text;
}

}  // namespace victorious::bench
