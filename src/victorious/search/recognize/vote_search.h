// recognize/, searches one model of many views in a scene: ranked matches (search/match/ranked_matcher.h) and Hough
// voting (search/pose/vote_poses.h) for each view, coarse to fine.
//
// 1. Coarse views: a maximal independent set of the view graph, so that every view is a coarse view or the neighbour of
//    one. All of them are matched, since neighbouring views look alike.
// 2. Refinement: the neighbours of the coarse views with the highest -log10 NFA. Less than half the cost for nearly the
//    same detections.
// 3. Pooling: the best views vote once more together with the matches of their neighbours
//    (search/pose/pooled_template.h).
//
// Priors. With a known camera attitude only views that an upright object can show are matched; with an unknown attitude
// the camera is assumed to be held upright (search/pose/upright_prior.h). With a known sun each view is also matched as
// a relit template: for an upright object, the view's azimuth determines the sun's direction in the model frame. In a
// wide field of view that direction varies, and each azimuth cell (azimuth_cells.h) uses its own sun. Rendering a relit
// template costs far more than matching it: coarse views are relit at half resolution, and only refined views at full
// resolution.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "victorious/search/recognize/model_searcher.h"
#include "victorious/search/recognize/vote_search_options.h"

namespace victorious {

class VoteSearch : public ModelSearcher {
 public:
  /// @param model            must outlive this
  /// @param relit_templates  source of the model's relit templates; null: none
  VoteSearch(const ObjectModel& model, std::shared_ptr<const RelitTemplateSource> relit_templates,
             const VoteSearchOptions& options, const PoseOptions& pose_options)
      : model_(model), relit_templates_(std::move(relit_templates)), options_(options), pose_options_(pose_options) {}

  [[nodiscard]] Expected<std::vector<Candidate>> Search(const PreparedScene& scene, const FrameConditions& conditions,
                                                        const ViewPart& part) const override;
  /// All views are matched; the four templates vote whose poses, as estimated from their matches, are the most
  /// significant.
  [[nodiscard]] Expected<std::vector<Candidate>> SearchViews(const PreparedScene& scene,
                                                             const FrameConditions& conditions,
                                                             std::span<const std::size_t> views) const override;
  [[nodiscard]] const RelitTemplateSource* relit_templates() const override { return relit_templates_.get(); }

 private:
  const ObjectModel& model_;
  std::shared_ptr<const RelitTemplateSource> relit_templates_;
  VoteSearchOptions options_;
  PoseOptions pose_options_;
};

}  // namespace victorious
