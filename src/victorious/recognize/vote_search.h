// One model of many views searched in a scene by votes: match/ranked_matcher.h and pose/vote_poses.h over its views.
//
// Neighbouring views look alike: a scene is first compared with every few, the scouts, of which each other view is a
// neighbour; then with the neighbours of those that found most. Less than half the work for nearly the same finds.
// Where most was found, the votes of neighbours are counted together, too (pose/pooled_template.h).
//
// Where the camera's attitude is known, only the views that an upright object can show are compared; where the sun is
// known, too, each also as the sun would show it: an object that stands upright and is seen from a view's azimuth has
// the sun in one place. A wide camera's lines of sight come from several azimuths; each place is compared under the sun
// of its own. Making a lit view costs far more than comparing it: those sought first are made coarsely, and
// sharp ones only of those followed. Where nobody tells the attitude, the camera is supposed to be held upright at
// least.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/detect/detect.h"
#include "victorious/match/ranked_matcher.h"
#include "victorious/pose/vote_poses.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct VoteSearchOptions {
  int nearest = 4;
  int most_followed = 6;
  int most_pooled = 6;
  int most_lit = 1000;
  double most_tilt_rad = 0.35;
  double most_hanging_rad = 0.35;
  double sun_step_rad = 0.35;
  double sun_evidence = 6.0;
  int most_asked = 8;
  VoteOptions votes;

  void ListFields(FieldList& fields);
};

/// A scene made ready, and how it is searched. The references outlive it.
struct VoteScene {
  const FeatureSet& features;
  const RankedMatcher& ranked;  ///< of the features
  const VoteSearchOptions& options;
  const PoseOptions& pose;
};

/// A view that may tell where the sun stands.
struct SunLead {
  std::size_t view;
  double evidence;  ///< decades, under a soft sky; minus infinity without any pose
};

struct SunFound {
  Sun ahead;        ///< as FrameConditions::sun_ahead
  double evidence;  ///< decades
};

/// Immutable once made: any number of threads may ask it at once.
class VoteSearch {
 public:
  /// @param model  outlives this
  /// @param lit    its views under a sun and as pictures; null: none
  VoteSearch(const ObjectModel& model, std::shared_ptr<const LitTemplates> lit)
      : model_(&model), lit_(std::move(lit)) {}

  [[nodiscard]] bool KnowsSuns() const { return lit_ != nullptr; }
  [[nodiscard]] const LitTemplates* lit() const { return lit_.get(); }

  /// The poses of every view compared; of Candidate, `model` is left to the caller.
  [[nodiscard]] std::vector<Candidate> Search(const VoteScene& scene, const FrameConditions& conditions) const;

  /// The same of these views alone: where it is known already how the object is seen.
  [[nodiscard]] std::vector<Candidate> SearchViews(const VoteScene& scene, const FrameConditions& conditions,
                                                   std::span<const std::size_t> views) const;

  /// What of the scene could tell where the sun stands: views seen from aside that an upright object can show, by their
  /// evidence under a soft sky. None without views under a sun.
  [[nodiscard]] std::vector<SunLead> FindSunLeads(const VoteScene& scene, const Vertical& vertical) const;

  /// Where the sun stands, from how an instance of the model is lit in one of these views; nothing where no sun brings
  /// options.sun_evidence, and as much more than a soft sky does that it is no chance.
  [[nodiscard]] std::optional<SunFound> FindSun(const VoteScene& scene, const Vertical& vertical,
                                                std::span<const SunLead> leads) const;

 private:
  const ObjectModel* model_;
  std::shared_ptr<const LitTemplates> lit_;
};

}  // namespace victorious
