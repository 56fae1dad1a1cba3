// recognize/, the options of the vote search (vote_search.h).
#pragma once

#include "victorious/base/options.h"
#include "victorious/pose/vote_poses.h"

namespace victorious {

struct VoteSearchOptions {
  int nearest = 4;
  int max_refined_views = 6;
  int max_pooled_views = 6;
  int max_relit_views = 1000;
  double max_tilt_rad = 0.35;
  double max_hanging_rad = 0.35;
  double sun_step_rad = 0.35;
  double min_sun_neg_log10_nfa = 6.0;
  int max_sun_views = 8;
  VoteOptions votes;

  void ListFields(FieldList& fields);
};

}  // namespace victorious
