// Filters that reject false matches, behind one interface for comparison: the cascade, its single stages, and
// baselines.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/match_trial.h"

namespace victorious {

enum class MatchFilterKind {
  kNone,
  kNeighbours,
  kSingleStage,
  kCascade,
  kCascadeThenMlesac,
  kMlesac,
  kOpenCvSimilarity,
  kOpenCvHomography,
  kVariant,  ///< the cascade with other options
};

struct MatchFilter {
  MatchFilterKind kind = MatchFilterKind::kVariant;
  std::string name;  ///< in reports
  std::function<MatchSet(const MatchTrial& trial, const MatchSet& matches)> run;
};

/// Returns, in this order: no filter; Video Google's neighbour voting; each stage alone; the cascade; the cascade
/// followed by MLESAC; MLESAC alone; OpenCV's similarity (estimateAffinePartial2D) and homography (findHomography),
/// both by RANSAC at 3 px.
std::vector<MatchFilter> MakeMatchFilters(const RecognizeOptions& options);

/// Returns the filter of grammar/ with these options.
MatchFilter MakeGrammarFilter(std::string name, const CascadeOptions& options,
                              MatchFilterKind kind = MatchFilterKind::kVariant);

}  // namespace victorious
