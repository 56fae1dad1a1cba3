// What drops wrong matches, one beside the other: the cascade, its stages alone, and what others do.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "victorious/evaluate/experiments/match_trial.h"

namespace victorious {

struct MatchFilter {
  std::string name;
  std::function<MatchSet(const MatchTrial& trial, const MatchSet& matches)> run;
};

/// Nothing; Video Google's neighbours; each stage alone; the cascade; MLESAC after it; MLESAC, OpenCV's similarity
/// (estimateAffinePartial2D) and homography (findHomography, both RANSAC at 3 px) alone.
std::vector<MatchFilter> MatchFilters(const RecognizeOptions& options);

/// The filter of grammar/ with these options.
MatchFilter GrammarFilter(std::string name, const CascadeOptions& options);

}  // namespace victorious
