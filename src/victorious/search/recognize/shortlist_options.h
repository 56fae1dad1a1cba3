// recognize/, the options of the shortlist search (shortlist_search.h). None is a user parameter: tests and experiments
// vary them. docs/adr/0018 has the measurements.
#pragma once

namespace victorious {

struct ShortlistOptions {
  int nearest = 2;  ///< scene keypoints per template keypoint, of those of allowed orientation
  /// Coarse views that are refined: proposed again at full resolution, with their neighbours.
  int max_refined = 8;
  /// Of them at one place in the scene, so that no instance crowds out another; half as many at a certain one.
  int max_refined_per_place = 4;
  /// Of their proposals, confirmed in the whole scene. Refinement makes templates at full resolution, the most costly
  /// part of a search for models that the scene does not show.
  double min_refined_neg_log10_nfa = 0.5;
  int max_verified = 12;                    ///< proposals that are matched and fitted in full, in one round
  int max_verified_per_place = 6;           ///< likewise
  double min_verified_neg_log10_nfa = 1.3;  ///< of their proposals, as for refinement: most others are of absent models
  /// Rounds of verification: another one, with as many more, if all significant poses so far are mostly out of view.
  int max_rounds = 3;
  double min_in_view = 0.5;  ///< fraction of the outline, as DetectOptions::min_in_view
  /// Verified views whose neighbours are verified, too, so that they can be pooled.
  int max_pooled = 2;
  double min_pooled_neg_log10_nfa = 0.5;  ///< of their poses
};

}  // namespace victorious
