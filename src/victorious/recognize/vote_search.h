// recognize/, searches one model of many views in a scene: ranked matches (match/ranked_matcher.h) and Hough voting
// (pose/vote_poses.h) for each view, coarse to fine.
//
// 1. Coarse views: a maximal independent set of the view graph, so that every view is a coarse view or the neighbour of
//    one. All of them are matched, since neighbouring views look alike.
// 2. Refinement: the neighbours of the coarse views with the highest -log10 NFA. Less than half the cost for nearly the
//    same detections.
// 3. Pooling: the best views vote once more together with the matches of their neighbours (pose/pooled_template.h).
//
// Priors. With a known camera attitude only views that an upright object can show are matched; with an unknown attitude
// the camera is assumed to be held upright (pose/upright_prior.h). With a known sun each view is also matched as a
// relit template: for an upright object, the view's azimuth determines the sun's direction in the model frame. In a
// wide field of view that direction varies, and each azimuth cell (azimuth_cells.h) uses its own sun. Rendering a relit
// template costs far more than matching it: coarse views are relit at half resolution, and only refined views at full
// resolution.
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
#include "victorious/recognize/relit_templates.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/frame_conditions.h"
#include "victorious/types/object_model.h"

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

/// A prepared scene and the search options. Non-owning: the referenced objects must outlive it.
struct PreparedScene {
  const FeatureSet& features;
  const RankedMatcher& ranked;  ///< made from `features`
  const VoteSearchOptions& options;
  const PoseOptions& fit;
};

/// A view whose shading in the scene may determine the sun's direction.
struct SunCandidateView {
  std::size_t view;
  double neg_log10_nfa;  ///< -log10 NFA of its best pose under diffuse light; minus infinity without a pose
};

/// An estimate of the sun's direction.
struct SunEstimate {
  Sun relative_sun;      ///< relative to the viewing direction, as FrameConditions::relative_sun
  double neg_log10_nfa;  ///< -log10 NFA of the pose that determines it
};

/// Immutable and thread-safe.
class VoteSearch {
 public:
  /// @param model  must outlive this
  /// @param relit_templates    source of the model's relit templates; null: none
  VoteSearch(const ObjectModel& model, std::shared_ptr<const RelitTemplateSource> relit_templates)
      : model_(&model), relit_templates_(std::move(relit_templates)) {}

  [[nodiscard]] bool HasRelitTemplates() const { return relit_templates_ != nullptr; }
  [[nodiscard]] const RelitTemplateSource* relit_templates() const { return relit_templates_.get(); }

  /// The poses of all views that are matched, as candidates for Detect(). The caller sets Candidate::model_index.
  [[nodiscard]] std::vector<Candidate> Search(const PreparedScene& scene, const FrameConditions& conditions) const;

  /// As Search(), for these views only, without the coarse-to-fine selection: the aspect is known.
  [[nodiscard]] std::vector<Candidate> SearchViews(const PreparedScene& scene, const FrameConditions& conditions,
                                                   std::span<const std::size_t> views) const;

  /// The coarse views that may determine the sun: oblique views that an upright object can show, with their -log10 NFA
  /// under diffuse light. In the order of the views; empty without relit templates.
  [[nodiscard]] std::vector<SunCandidateView> FindSunCandidateViews(const PreparedScene& scene,
                                                                    const Vertical& vertical) const;

  /// Estimates the sun by matching these views relit from eight azimuths at 45 degrees elevation, then on a 10 degree
  /// grid around the best. std::nullopt if the best -log10 NFA is below options.min_sun_neg_log10_nfa or less than one
  /// decade above that of diffuse light.
  [[nodiscard]] std::optional<SunEstimate> EstimateSun(const PreparedScene& scene, const Vertical& vertical,
                                                       std::span<const SunCandidateView> candidates) const;

 private:
  const ObjectModel* model_;
  std::shared_ptr<const RelitTemplateSource> relit_templates_;
};

}  // namespace victorious
