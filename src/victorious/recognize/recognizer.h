// recognize/, the stages from match to detect as one call: what index, match, search by picture (and later tracking and
// navigation) share. In: a scene's features. Out: the models' instances in it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/detect/detect.h"
#include "victorious/grammar/cascade.h"
#include "victorious/match/matcher.h"
#include "victorious/pose/similarity_pose.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct RecognizeOptions {
  MatchOptions match;
  CascadeOptions cascade;
  PoseOptions pose;
  DetectOptions detect;

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
  /// Errors: kInvalidArgument for options out of range or models of another engine.
  static Expected<Recognizer> Create(std::vector<ObjectModel> models, const std::string& engine,
                                     const RecognizeOptions& options);

  [[nodiscard]] const std::vector<ObjectModel>& models() const { return models_; }

  /// Every instance of every model, best first. Deterministic.
  [[nodiscard]] std::vector<Detection> Recognize(const FeatureSet& scene) const;

  /// The same for one view of one model, stage by stage.
  [[nodiscard]] StagedMatches MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const;

 private:
  struct ViewRef {
    std::size_t model;
    std::size_t view;
  };

  Recognizer(std::vector<ObjectModel> models, std::vector<ViewRef> views, TemplateSet templates,
             const RecognizeOptions& options);

  [[nodiscard]] StagedMatches Filter(const FeatureSet& scene, const ViewRef& ref, MatchSet matches) const;

  std::vector<ObjectModel> models_;
  std::vector<ViewRef> views_;  ///< of all models, in the order of templates_
  TemplateSet templates_;
  RecognizeOptions options_;
};

}  // namespace victorious
