// recognize/, the stages from match to detect as one call: what index, match, search by picture (and later tracking and
// navigation) share. In: a scene's features. Out: the models' instances in it.
//
// Two ways lead from matches to poses. The grammar is the thesis's: ratio test, cascade, MLESAC. Votes (vote_search.h)
// use matches that no ratio test lets through, and find models of little texture in cluttered scenes; what they leave
// in doubt the scene's picture may decide (likeness.h).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/detect/detect.h"
#include "victorious/grammar/cascade.h"
#include "victorious/match/matcher.h"
#include "victorious/pose/similarity_pose.h"
#include "victorious/recognize/likeness.h"
#include "victorious/recognize/vote_search.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct RecognizeOptions {
  std::string method = "auto";
  VoteSearchOptions search;
  MatchOptions match;
  CascadeOptions cascade;
  PoseOptions pose;
  DetectOptions detect;
  LikenessOptions likeness;

  void ListFields(FieldList& fields);
};

/// What each stage left of one template's matches.
struct StagedMatches {
  MatchSet ratio;
  CascadeResult cascade;
  std::vector<Pose> poses;  ///< best supported first
};

/// OK if all models have features of this engine; else kInvalidArgument with the first that has not.
Status CheckEngine(std::span<const ObjectModel> models, std::string_view engine);

/// Immutable once made: any number of threads may ask it at once.
class Recognizer {
 public:
  /// @param engine  of the scenes' features (CheckEngine)
  /// @param lit     each model's views under a sun and as pictures, null where there are none; or empty: of no model
  /// Errors: kInvalidArgument for options out of range or models of another engine.
  static Expected<Recognizer> Create(std::vector<ObjectModel> models, const std::string& engine,
                                     const RecognizeOptions& options,
                                     const std::vector<std::shared_ptr<const LitTemplates>>& lit = {});

  [[nodiscard]] const std::vector<ObjectModel>& models() const { return *models_; }

  /// Every instance of every model, best first. Deterministic.
  /// @param conditions  as far as known: models of known views are sought upright, and lit as the sun lights them
  /// @param grey        the scene, CV_8UC1, to look again at what votes leave in doubt; empty: they decide
  [[nodiscard]] std::vector<Detection> Recognize(const FeatureSet& scene, const FrameConditions& conditions = {},
                                                 const cv::Mat& grey = {}) const;

  /// Of one model, those that some of its views show: where it is known already what is seen, and about how.
  /// @param scene  of the part of a frame where it should be, in the frame's pixels
  [[nodiscard]] std::vector<Detection> RecognizeViews(const FeatureSet& scene, std::size_t model,
                                                      std::span<const std::size_t> views,
                                                      const FrameConditions& conditions) const;

  /// Whether FindSun() can tell anything: a model has views under a sun.
  [[nodiscard]] bool KnowsSuns() const;

  /// Where the sun stands, from how an object in the scene is lit; mostly nothing.
  [[nodiscard]] std::optional<SunFound> FindSun(const FeatureSet& scene, const Vertical& vertical) const;

  /// One view of one model by the grammar, whatever the method, stage by stage.
  [[nodiscard]] StagedMatches MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const;

 private:
  struct ViewRef {
    std::size_t model;
    std::size_t view;
  };

  Recognizer(std::vector<ObjectModel> models, const RecognizeOptions& options,
             const std::vector<std::shared_ptr<const LitTemplates>>& lit);

  [[nodiscard]] StagedMatches Filter(const FeatureSet& scene, const ViewRef& ref, MatchSet matches) const;
  void SearchByGrammar(const FeatureSet& scene, std::vector<Candidate>& candidates) const;
  void SearchByVotes(const FeatureSet& scene, const FrameConditions& conditions,
                     std::vector<Candidate>& candidates) const;
  void WeighByLikeness(const cv::Mat& grey, std::vector<Detection>& detections) const;

  std::shared_ptr<const std::vector<ObjectModel>> models_;  ///< where it is, however often this moves
  std::vector<ViewRef> views_;  ///< of the models searched by the grammar, in the order of templates_
  TemplateSet templates_;
  std::vector<std::pair<std::size_t, VoteSearch>> voters_;  ///< the models searched by votes
  RecognizeOptions options_;
};

}  // namespace victorious
