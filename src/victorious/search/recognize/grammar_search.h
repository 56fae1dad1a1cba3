// recognize/, searches one model by the thesis's method: ratio test (search/match/matcher.h), cascade
// (search/grammar/cascade.h), MLESAC (search/pose/similarity_pose.h), for each view by itself. Source: thesis, sections
// 3.3 and 3.5.3.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "victorious/search/grammar/cascade.h"
#include "victorious/search/match/matcher.h"
#include "victorious/search/pose/similarity_pose.h"
#include "victorious/search/recognize/model_searcher.h"
#include "victorious/types/match_set.h"
#include "victorious/types/planar_fit.h"

namespace victorious {

struct GrammarSearchOptions {
  MatchOptions match;
  CascadeOptions cascade;
  PoseOptions pose;
};

/// The matches of one template after each stage.
struct StagedMatches {
  MatchSet ratio;
  CascadeResult cascade;
  std::vector<PlanarFit> fits;  ///< by falling number of distinct inliers
};

/// The stages of the grammar for one view.
/// @param matches  of the scene and the view, after the ratio test
[[nodiscard]] StagedMatches FilterAndFit(const FeatureSet& scene, const ObjectModel& model, std::size_t view,
                                         MatchSet matches, const GrammarSearchOptions& options);

/// Matches one view and filters its matches by FilterAndFit().
[[nodiscard]] StagedMatches MatchViewByGrammar(const PreparedScene& scene, const ObjectModel& model, std::size_t view,
                                               const GrammarSearchOptions& options);

class GrammarSearch : public ModelSearcher {
 public:
  /// @param model  must outlive this
  GrammarSearch(const ObjectModel& model, const GrammarSearchOptions& options);

  [[nodiscard]] Expected<std::vector<Candidate>> Search(const PreparedScene& scene, const FrameConditions& conditions,
                                                        const ViewPart& part) const override;
  [[nodiscard]] Expected<std::vector<Candidate>> SearchViews(const PreparedScene& scene,
                                                             const FrameConditions& conditions,
                                                             std::span<const std::size_t> views) const override;

 private:
  const ObjectModel& model_;
  GrammarSearchOptions options_;
  TemplateSet templates_;  // one per view
};

}  // namespace victorious
