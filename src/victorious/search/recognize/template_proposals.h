// recognize/, for ShortlistSearch: estimates how significant the best pose of each template of one model is.
#pragma once

#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/search/pose/pose_proposal.h"
#include "victorious/search/recognize/azimuth_cells.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/shortened_views.h"
#include "victorious/search/recognize/template_variant.h"
#include "victorious/search/recognize/vote_search_options.h"

namespace victorious {

/// A template and the estimate of its best pose.
struct TemplateProposal {
  TemplateVariant variant;
  PoseProposal pose;
};

/// Estimates the poses of templates. Those without a pose are left out.
/// @param relit_templates  null if no variant has a sun
/// @param cells            of the searched region: the off-nadir angles of its lines of sight
/// @param nearest          scene keypoints per template keypoint, of those of allowed orientation
/// Errors: those of RelitTemplateSource.
[[nodiscard]] Expected<std::vector<TemplateProposal>> ProposeTemplates(
    const ShortenedViews& views, const RelitTemplateSource* relit_templates, const PreparedScene& scene,
    const AzimuthCells& cells, const VoteSearchOptions& options, std::span<const TemplateVariant> variants,
    int nearest);

/// Which proposals to keep: the most significant ones.
struct ProposalSelection {
  int max_count;
  /// At one position in the scene, so that one instance does not crowd out another; half as many at a certain one.
  int max_per_place;
  double min_neg_log10_nfa;
};

/// The selected proposals, by falling -log10 NFA.
std::vector<TemplateProposal> BestProposals(std::vector<TemplateProposal> proposals,
                                            const ProposalSelection& selection);

}  // namespace victorious
