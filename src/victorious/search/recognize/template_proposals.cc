#include "victorious/search/recognize/template_proposals.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "victorious/base/stage_time.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/pose/upright_prior.h"
#include "victorious/search/recognize/model_matcher.h"

namespace victorious {
namespace {

// The vertical's image leans differently at a keypoint and at the object's centre, where the prior holds.
constexpr double kLeanDifference_rad = 0.06;
// Poses nearer to each other than this fraction of the smaller one's size show the same instance.
constexpr double kSamePlaceFraction = 0.5;

// A proposal of this -log10 NFA is certain to show an instance: half of the others at its place suffice.
constexpr double kCertainNegLog10Nfa = 10;

// Proposals from this -log10 NFA on are confirmed by ranks in the whole scene: any other one is too
// insignificant to be refined or verified (ShortlistOptions).
constexpr double kMinConfirmedNegLog10Nfa = -1;
constexpr int kMaxSceneRank = 8;

// The mean of a proposal's -log10 NFA by the ranks of its inliers among the keypoints of allowed orientation, and by
// those among all keypoints, which are counted up to kMaxSceneRank; for the proposals that may be significant.
void ConfirmInScene(const PreparedScene& scene, std::span<const UprightTemplate> templates,
                    std::span<std::optional<PoseProposal>> poses) {
  const auto is_confirmed = [](const std::optional<PoseProposal>& pose) {
    return pose && pose->neg_log10_nfa >= kMinConfirmedNegLog10Nfa;
  };
  std::vector<std::uint8_t> rows;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!is_confirmed(poses[i])) continue;
    for (const RankedMatch& inlier : poses[i]->inliers) {
      std::ranges::copy(templates[i].features.Descriptor(inlier.template_keypoint), std::back_inserter(rows));
    }
  }
  const kernels::PackedQueries inliers = kernels::PackQueries(rows);
  const std::vector<RankedMatch> matches = scene.ranked_matcher().MatchAll({&inliers, 1}, kMaxSceneRank).front();
  std::size_t first = 0;  // of the pose's inliers' matches
  for (std::optional<PoseProposal>& pose : poses) {
    if (!is_confirmed(pose) || matches.empty()) continue;
    std::vector<RankedMatch> confirmed;
    for (const RankedMatch& inlier : pose->inliers) {
      for (const RankedMatch& match : std::span(matches).subspan(first, kMaxSceneRank)) {
        if (match.scene_keypoint == inlier.scene_keypoint)
          confirmed.push_back({inlier.scene_keypoint, inlier.template_keypoint, match.rank});
      }
      first += kMaxSceneRank;
    }
    const double in_scene = NegLog10NfaOfRanks(*pose, scene.features(), std::move(confirmed), kPi);
    pose->neg_log10_nfa = (pose->neg_log10_nfa + in_scene) / 2;
  }
}

bool AreAtOnePlace(const PoseProposal& a, const PoseProposal& b) {
  return (a.centre_px - b.centre_px).norm() < kSamePlaceFraction * std::min(a.size_px, b.size_px);
}

}  // namespace

Expected<std::vector<TemplateProposal>> ProposeTemplates(const ShortenedViews& views,
                                                         const RelitTemplateSource* relit_templates,
                                                         const PreparedScene& scene, const AzimuthCells& cells,
                                                         const VoteSearchOptions& options,
                                                         std::span<const TemplateVariant> variants, int nearest) {
  const ObjectModel& model = views.model();
  std::vector<RelitTemplateKey> needed;
  for (const TemplateVariant& variant : variants) {
    if (variant.sun_view) needed.push_back({*variant.sun_view, variant.view, variant.half_resolution});
  }
  if (!needed.empty()) relit_templates->Prepare(needed);
  std::vector<std::shared_ptr<const RelitTemplate>> relit(variants.size());
  std::vector<UprightTemplate> all;
  std::map<double, std::vector<std::size_t>> by_max_turn;  // indices into variants
  std::vector<std::optional<UprightPrior>> priors;
  const auto [min_ray_rad, max_ray_rad] = cells.OffNadirRange();
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const TemplateVariant& variant = variants[i];
    if (variant.sun_view) {
      VICTORIOUS_ASSIGN_OR_RETURN(
          relit[i], relit_templates->GetTemplate({*variant.sun_view, variant.view, variant.half_resolution}));
    }
    all.push_back(relit[i] ? UprightTemplate{relit[i]->features.View(), &relit[i]->shortened} : views.Of(variant.view));
    const std::optional<UprightPrior>& prior =
        priors.emplace_back(MakeUprightPrior(model.views[variant.view], scene.vertical(), options));
    by_max_turn[prior ? prior->MaxTurnFromLean(min_ray_rad, max_ray_rad) : kPi].push_back(i);
  }

  std::vector<TemplateProposal> proposals;
  for (const auto& [max_turn_rad, indices] : by_max_turn) {
    std::vector<UprightTemplate> templates;
    for (const std::size_t i : indices) templates.push_back(all[i]);
    std::vector<std::vector<RankedMatch>> matches;
    {
      const StageScope scope(Stage::kMatching);
      matches = scene.upright_matcher().Match(templates, std::min(kPi, max_turn_rad + kLeanDifference_rad), nearest);
    }
    std::vector<std::optional<PoseProposal>> poses;
    {
      const StageScope scope(Stage::kPoses);
      for (std::size_t k = 0; k < indices.size(); ++k) {
        const std::optional<UprightPrior>& prior = priors[indices[k]];
        std::optional<PoseProposal>& pose = poses.emplace_back(
            ProposePose(scene.features(), scene.density(), templates[k].features.keypoints, matches[k],
                        model.views[variants[indices[k]].view].outline, max_turn_rad, prior));
        if (!pose || !prior) continue;
        pose->neg_log10_nfa += prior->SearchReductionDecades();
        pose->log10_pose_count -= prior->SearchReductionDecades();
      }
    }
    const StageScope scope(Stage::kMatching);
    ConfirmInScene(scene, templates, poses);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (poses[k]) proposals.push_back({variants[indices[k]], *std::move(poses[k])});
    }
  }
  return proposals;
}

std::vector<TemplateProposal> BestProposals(std::vector<TemplateProposal> proposals,
                                            const ProposalSelection& selection) {
  std::ranges::stable_sort(proposals, std::greater{},
                           [](const TemplateProposal& one) { return one.pose.neg_log10_nfa; });
  std::vector<TemplateProposal> best;
  for (TemplateProposal& one : proposals) {
    if (std::ssize(best) >= selection.max_count || one.pose.neg_log10_nfa < selection.min_neg_log10_nfa) break;
    int at_its_place = 0;
    bool is_certain_place = false;
    for (const TemplateProposal& other : best) {
      if (!AreAtOnePlace(one.pose, other.pose)) continue;
      ++at_its_place;
      is_certain_place = is_certain_place || other.pose.neg_log10_nfa >= kCertainNegLog10Nfa;
    }
    const int max_there = is_certain_place ? (selection.max_per_place + 1) / 2 : selection.max_per_place;
    if (at_its_place < max_there) best.push_back(std::move(one));
  }
  return best;
}

}  // namespace victorious
