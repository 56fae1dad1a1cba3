// recognize/, the stages match, grammar, pose and detect as one call, shared by indexing, `match` and the search by
// image. In: a scene's features. Out: the detections of all models.
//
// Two methods lead from matches to poses. The grammar is the thesis's: ratio test, cascade, MLESAC. The vote search
// (vote_search.h) uses matches that fail the ratio test and finds models of little texture in cluttered scenes; an NCC
// comparison with the image rescores its uncertain detections (ncc_rescoring.h).
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
#include "victorious/recognize/ncc_rescoring.h"
#include "victorious/recognize/relit_templates.h"
#include "victorious/recognize/vote_search.h"
#include "victorious/types/detection.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct RecognizeOptions {
  std::string method = "auto";
  VoteSearchOptions search;
  MatchOptions match;
  CascadeOptions cascade;
  PoseOptions pose;
  DetectOptions detect;
  NccOptions ncc;

  void ListFields(FieldList& fields);
};

/// The matches of one template after each stage.
struct StagedMatches {
  MatchSet ratio;
  CascadeResult cascade;
  std::vector<PlanarFit> fits;  ///< by falling number of distinct inliers
};

/// Errors: kInvalidArgument with the name of the first model whose features come from another engine.
Status CheckEngine(std::span<const ObjectModel> models, std::string_view engine);

/// Finds the instances of models in scenes. Immutable and thread-safe.
class Recognizer {
 public:
  /// @param engine  feature engine of the scenes (CheckEngine)
  /// @param relit_templates     one source of relit templates per model, null for a model without; or empty for none at
  /// all Errors: kInvalidArgument for options out of range or models of another engine.
  static Expected<Recognizer> Create(
      std::vector<ObjectModel> models, const std::string& engine, const RecognizeOptions& options,
      const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates = {});

  [[nodiscard]] const std::vector<ObjectModel>& models() const { return *models_; }

  /// The detections of all models, by falling score. Deterministic.
  /// @param conditions  known priors: restrict models with known view angles to upright poses, and relight their
  ///                    templates for the sun
  /// @param grey        the scene's image, CV_8UC1, for the NCC rescoring of uncertain detections; empty: no rescoring
  [[nodiscard]] std::vector<Detection> Recognize(const FeatureSet& scene, const FrameConditions& conditions = {},
                                                 const cv::Mat& grey = {}) const;

  /// The detections of some views of one model, for tracking: the object and its approximate aspect are known.
  /// @param scene  features of a region of interest, in the frame's pixels
  /// @param model  index into models()
  /// @param views  indices into the model's views
  [[nodiscard]] std::vector<Detection> RecognizeViews(const FeatureSet& scene, std::size_t model,
                                                      std::span<const std::size_t> views,
                                                      const FrameConditions& conditions) const;

  /// True if EstimateSun() can succeed: at least one model has relit templates.
  [[nodiscard]] bool HasRelitTemplates() const;

  /// Estimates the sun's direction from the shading of an object in the scene. std::nullopt in most scenes: no object
  /// is significant enough (VoteSearch::EstimateSun).
  [[nodiscard]] std::optional<SunEstimate> EstimateSun(const FeatureSet& scene, const Vertical& vertical) const;

  /// The stages of the grammar for one view of one model, independent of the configured method.
  [[nodiscard]] StagedMatches MatchView(const FeatureSet& scene, std::size_t model, std::size_t view) const;

 private:
  struct ViewRef {
    std::size_t model;
    std::size_t view;
  };

  Recognizer(std::vector<ObjectModel> models, const RecognizeOptions& options,
             const std::vector<std::shared_ptr<const RelitTemplateSource>>& relit_templates);

  [[nodiscard]] StagedMatches Filter(const FeatureSet& scene, const ViewRef& ref, MatchSet matches) const;
  void SearchByGrammar(const FeatureSet& scene, std::vector<Candidate>& candidates) const;
  void SearchByVotes(const FeatureSet& scene, const FrameConditions& conditions,
                     std::vector<Candidate>& candidates) const;
  void RescoreByNcc(const cv::Mat& grey, std::vector<Detection>& detections) const;

  std::shared_ptr<const std::vector<ObjectModel>> models_;  ///< on the heap: the vote searches keep pointers to models
  std::vector<ViewRef> views_;  ///< of the models searched by the grammar, in the order of templates_
  TemplateSet templates_;
  std::vector<std::pair<std::size_t, VoteSearch>>
      vote_searches_;  ///< model index and search of the models searched by votes
  RecognizeOptions options_;
};

}  // namespace victorious
