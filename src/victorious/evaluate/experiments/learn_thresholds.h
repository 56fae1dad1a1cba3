// The cascade's thresholds from pictures with truth, to be held against table 3.1's, which the thesis set by hand.
#pragma once

#include <vector>

#include "victorious/evaluate/experiments/match_trial.h"
#include "victorious/grammar/cascade.h"

namespace victorious {

/// Distortions: what 98 % of pairs of true matches within R stay below. Approvals and votes: of a grid, those that lose
/// fewest true matches at ratios of 0.8 and 0.95 together, where one false match left costs as much as two true ones
/// lost.
/// @param start  for all that is not learnt
CascadeOptions LearnThresholds(const std::vector<const MatchTrial*>& trials, const CascadeOptions& start);

}  // namespace victorious
