// recognize/, the options of the vote search (vote_search.h).
#pragma once

#include "victorious/base/options.h"
#include "victorious/search/pose/vote_poses.h"

namespace victorious {

struct VoteSearchOptions {
  int nearest = 4;
  double max_tilt_rad = 0.35;
  double max_hanging_rad = 0.35;

  // Not user parameters from here on: the tests vary them.
  /// Coarse views whose neighbours are matched, too: those of the highest -log10 NFA (docs/adr/0008).
  int max_refined_views = 6;
  /// Quantisation step of the sun's azimuth for relit templates. Finer is more accurate, and needs more renderings and
  /// memory (docs/adr/0010).
  double sun_step_rad = 0.35;
  VoteOptions votes;

  void ListFields(FieldList& fields);
};

}  // namespace victorious
