// recognize/, the options of the shortlist search (shortlist_search.h). None is a user parameter: tests and experiments
// vary them. docs/adr/0018 has the measurements.
#pragma once

namespace victorious {

struct ShortlistOptions {
  int nearest = 2;  ///< scene keypoints per template keypoint, of those of allowed orientation
  /// Coarse views that are refined: proposed again at full resolution, with their neighbours.
  int max_refined = 6;
  double min_refined_neg_log10_nfa = -1;  ///< of their proposals
  int max_verified = 4;                   ///< proposals that are matched and fitted in full
  double min_verified_neg_log10_nfa = 0;  ///< of their proposals
  /// Verified views whose neighbours are verified, too, so that they can be pooled.
  int max_pooled = 2;
  double min_pooled_neg_log10_nfa = -1;  ///< of their poses
};

}  // namespace victorious
