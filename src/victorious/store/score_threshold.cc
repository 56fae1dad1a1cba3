#include "victorious/store/score_threshold.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace victorious {
namespace {

constexpr std::int64_t kParts = 10'000;  // of a score

// The roundest number above `below` and not above `above`, both in parts.
std::int64_t RoundestBetween(std::int64_t below, std::int64_t above) {
  for (const std::int64_t step : {kParts / 100, kParts / 1000}) {
    const std::int64_t next = (below / step + 1) * step;
    if (next <= above) return next;
  }
  return below + 1;
}

}  // namespace

std::optional<ScoreThreshold> LearnThreshold(std::span<const DecidedScore> decisions) {
  if (std::ssize(decisions) < kMinDecisions) return std::nullopt;
  struct Group {
    std::int64_t accepted = 0;
    std::int64_t rejected = 0;
  };
  std::map<std::int64_t, Group> groups;  // by score, in parts
  for (const DecidedScore& one : decisions) {
    Group& group = groups[std::llround(std::clamp(one.score, 0.0, 1.0) * kParts)];
    ++(one.is_accepted ? group.accepted : group.rejected);
  }
  std::optional<ScoreThreshold> best;
  std::int64_t min_change = 0;  // of the cost, to that without a threshold
  ScoreThreshold below;
  for (auto at = groups.begin(); at != groups.end(); ++at) {
    below.accepted_below += at->second.accepted;
    below.rejected_below += at->second.rejected;
    const std::int64_t change = kMissCost * below.accepted_below - below.rejected_below;
    if (change >= min_change || below.rejected_below < kMinRejectedBelow || at->first >= kParts) continue;
    min_change = change;
    const auto next = std::next(at);
    const std::int64_t above = next == groups.end() ? kParts : next->first;
    below.min_score = static_cast<double>(RoundestBetween(at->first, above)) / kParts;
    best = below;
  }
  return best;
}

}  // namespace victorious
