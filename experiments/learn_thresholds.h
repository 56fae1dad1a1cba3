// Learns the thresholds of the grammar's cascade from images with ground truth, for comparison with table 3.1, whose
// values the thesis set by hand.
#pragma once

#include <vector>

#include "experiments/match_trial.h"
#include "victorious/search/grammar/cascade.h"

namespace victorious {

/// Distortion thresholds: the 98th percentile over the pairs of true matches within the radius R. Approvals and votes:
/// a grid search that minimises (true matches lost) + 2 (false matches left), summed over the ratios 0.8 and 0.95.
/// @param start  supplies all parameters that are not learnt
/// Cost: 54 runs of the cascade per trial and ratio.
CascadeOptions LearnThresholds(const std::vector<const MatchTrial*>& trials, const CascadeOptions& start);

}  // namespace victorious
