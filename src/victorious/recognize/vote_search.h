// One model of many views searched in a scene by votes: match/ranked_matcher.h and pose/vote_poses.h over its views.
//
// Neighbouring views look alike: a scene is first compared with every few, the scouts, of which each other view is a
// neighbour; then with the neighbours of those that found most. Less than half the work for nearly the same finds.
#pragma once

#include <cstddef>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/detect/detect.h"
#include "victorious/kernels/nearest.h"
#include "victorious/match/ranked_matcher.h"
#include "victorious/pose/vote_poses.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct VoteSearchOptions {
  int nearest = 4;
  int most_followed = 6;
  VoteOptions votes;

  void ListFields(FieldList& fields);
};

/// Immutable once made: any number of threads may ask it at once.
class VoteSearch {
 public:
  explicit VoteSearch(const ObjectModel& model);

  /// The poses of every view compared; of Candidate, `model` is left to the caller.
  /// @param ranked  the same scene, made ready
  [[nodiscard]] std::vector<Candidate> Search(const ObjectModel& model, const FeatureSet& scene,
                                              const RankedMatcher& ranked, const VoteSearchOptions& options,
                                              const PoseOptions& pose) const;

 private:
  std::vector<kernels::PackedQueries> views_;
  std::vector<std::size_t> scouts_;
};

}  // namespace victorious
