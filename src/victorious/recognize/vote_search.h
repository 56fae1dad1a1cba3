// One model of many views searched in a scene by votes: match/ranked_matcher.h and pose/vote_poses.h over its views.
//
// Neighbouring views look alike: a scene is first compared with every few, the scouts, of which each other view is a
// neighbour; then with the neighbours of those that found most. Less than half the work for nearly the same finds.
// Where the camera's attitude is known, only with the views that an upright object can show.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/detect/detect.h"
#include "victorious/geometry/vertical.h"
#include "victorious/kernels/nearest.h"
#include "victorious/match/ranked_matcher.h"
#include "victorious/pose/vote_poses.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct VoteSearchOptions {
  int nearest = 4;
  int most_followed = 6;
  double most_tilt_rad = 0.35;
  VoteOptions votes;

  void ListFields(FieldList& fields);
};

/// Immutable once made: any number of threads may ask it at once.
class VoteSearch {
 public:
  explicit VoteSearch(const ObjectModel& model);

  /// The poses of every view compared; of Candidate, `model` is left to the caller.
  /// @param ranked    the same scene, made ready
  /// @param vertical  which way is up in the scene, if known
  [[nodiscard]] std::vector<Candidate> Search(const ObjectModel& model, const FeatureSet& scene,
                                              const RankedMatcher& ranked, const std::optional<Vertical>& vertical,
                                              const VoteSearchOptions& options, const PoseOptions& pose) const;

 private:
  std::vector<kernels::PackedQueries> views_;
};

}  // namespace victorious
