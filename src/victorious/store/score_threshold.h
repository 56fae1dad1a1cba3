// The score below which the objects of a model are mostly false, learnt from what people decided about them.
//
// Of all thresholds t, the one with the least cost of the decisions is taken:
//   cost(t) = |rejected with score >= t| + kMissCost |accepted with score < t|
// and of equal ones the lowest: recall comes first. A score is a probability that the same formula gives for all
// models; where that formula misjudges a model, the decisions say so.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace victorious {

/// The score of an object, and the team's verdict.
struct DecidedScore {
  double score = 0;
  bool is_accepted = false;
};

struct ScoreThreshold {
  double min_score = 0;  ///< as few decimals as tell the scores apart, at most 4
  std::int64_t accepted_below = 0;
  std::int64_t rejected_below = 0;
};

/// Accepts and rejects of a model, together, from which on a threshold is learnt. With fewer, one decision more would
/// move it far.
inline constexpr std::int64_t kMinDecisions = 10;
/// Rejects that must lie below a threshold.
inline constexpr std::int64_t kMinRejectedBelow = 3;
/// False objects that count as much as one real object that is missed.
inline constexpr std::int64_t kMissCost = 4;

/// Returns std::nullopt with fewer than kMinDecisions, or if no threshold costs less than none. Scores are compared to
/// four decimals, as they are shown.
[[nodiscard]] std::optional<ScoreThreshold> LearnThreshold(std::span<const DecidedScore> decisions);

}  // namespace victorious
