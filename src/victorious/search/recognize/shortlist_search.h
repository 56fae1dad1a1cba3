// recognize/, searches one model of many views in a scene by proposal and verification: the vote search (vote_search.h)
// for a fraction of its cost.
//
// 1. Propose: all coarse views, under diffuse light and relit, are matched only with scene keypoints of allowed
//    orientation, by shortened descriptors (search/match/upright_matcher.h); the significance of their best pose is
//    estimated (search/pose/pose_proposal.h).
// 2. Refine: the best of them are proposed again at full resolution, together with their neighbours.
// 3. Verify: the best proposals are matched with the whole scene, fitted and tested as the vote search does it, and
//    pooled with their neighbours. Candidates come from this step only, by the same number of tests, so that the
//    -log10 NFA means the same.
//
// A proposal below a minimum significance is dropped, so that a model that the scene does not show costs little more
// than step 1. Proposals may miss a view; verification is exact. docs/adr/0018 has the measurements.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "victorious/search/recognize/model_searcher.h"
#include "victorious/search/recognize/shortened_views.h"
#include "victorious/search/recognize/shortlist_options.h"
#include "victorious/search/recognize/vote_search.h"

namespace victorious {

class ShortlistSearch : public ModelSearcher {
 public:
  /// @param model            must outlive this
  /// @param shortened        of the model
  /// @param relit_templates  source of the model's relit templates; null: none
  ShortlistSearch(const ObjectModel& model, std::shared_ptr<const ShortenedViews> shortened,
                  std::shared_ptr<const RelitTemplateSource> relit_templates, const VoteSearchOptions& options,
                  const ShortlistOptions& shortlist, const PoseOptions& pose_options)
      : model_(model),
        relit_templates_(relit_templates),
        options_(options),
        shortlist_(shortlist),
        pose_options_(pose_options),
        shortened_(std::move(shortened)),
        few_views_(model, std::move(relit_templates), options, pose_options) {}

  [[nodiscard]] Expected<std::vector<Candidate>> Search(const PreparedScene& scene, const FrameConditions& conditions,
                                                        const ViewPart& part) const override;
  /// As the vote search: few views need no proposals.
  [[nodiscard]] Expected<std::vector<Candidate>> SearchViews(const PreparedScene& scene,
                                                             const FrameConditions& conditions,
                                                             std::span<const std::size_t> views) const override {
    return few_views_.SearchViews(scene, conditions, views);
  }
  [[nodiscard]] const RelitTemplateSource* relit_templates() const override { return relit_templates_.get(); }

 private:
  const ObjectModel& model_;
  std::shared_ptr<const RelitTemplateSource> relit_templates_;
  VoteSearchOptions options_;
  ShortlistOptions shortlist_;
  PoseOptions pose_options_;
  std::shared_ptr<const ShortenedViews> shortened_;
  VoteSearch few_views_;
};

}  // namespace victorious
