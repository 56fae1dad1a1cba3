#include "victorious/search/recognize/match_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/check.h"
#include "victorious/geometry/angles.h"
#include "victorious/search/detect/detect.h"
#include "victorious/search/pose/pooled_template.h"
#include "victorious/search/pose/vote_poses.h"
#include "victorious/search/recognize/grammar_search.h"
#include "victorious/search/recognize/model_matcher.h"
#include "victorious/search/recognize/model_searcher.h"
#include "victorious/search/recognize/prepared_scene.h"
#include "victorious/search/recognize/template_matcher.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

// A pose is that of the sighting if their boxes overlap by this (intersection over union): another search may place the
// outline a little differently.
constexpr double kMinOverlap = 0.3;

// A match by its keypoints; the same match in every stage.
using MatchKey = std::tuple<std::uint32_t, float, float>;

MatchKey KeyOf(std::uint32_t scene_keypoint, const Keypoint& in_template) {
  return {scene_keypoint, in_template.x, in_template.y};
}

// The stages of one template.
class StageList {
 public:
  StageList(const FeatureSet& scene, std::span<const Keypoint> keypoints) : scene_(scene), keypoints_(keypoints) {}

  // Adds the first stage, or one that is a subset of the stage before.
  // @param matches  a range of Match or RankedMatch
  template <typename Matches>
  void Add(EvidenceStage stage, const Matches& matches) {
    std::set<MatchKey> keys;
    for (const auto& match : matches) {
      const Keypoint& keypoint = keypoints_[match.template_keypoint];
      const MatchKey key = KeyOf(match.scene_keypoint, keypoint);
      if (!keys.insert(key).second || !evidence_.stages.empty()) continue;
      const Keypoint& in_scene = scene_.keypoints[match.scene_keypoint];
      evidence_.matches.push_back({{keypoint.x, keypoint.y}, {in_scene.x, in_scene.y}, 1});
      keys_.push_back(key);
    }
    Raise(stage, keys);
  }

  void AddInliers(const PlanarFit* fit) {
    std::set<MatchKey> keys;
    if (fit != nullptr) {
      for (const FitInlier& one : fit->inliers) keys.insert(KeyOf(one.scene_keypoint, one.keypoint_in_template));
    }
    Raise(EvidenceStage::kInliers, keys);
  }

  MatchEvidence Take() {
    std::ranges::stable_sort(evidence_.matches, std::greater{}, &EvidenceMatch::stages);
    return std::move(evidence_);
  }

 private:
  // A match passes a stage only if it passed all before.
  void Raise(EvidenceStage stage, const std::set<MatchKey>& keys) {
    const std::size_t before = evidence_.stages.size();
    std::size_t count = 0;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      std::size_t& stages = evidence_.matches[i].stages;
      if (before > 0 && (stages != before || !keys.contains(keys_[i]))) continue;
      stages = before + 1;
      ++count;
    }
    evidence_.stages.push_back({stage, count});
  }

  const FeatureSet& scene_;
  std::span<const Keypoint> keypoints_;
  MatchEvidence evidence_;
  std::vector<MatchKey> keys_;  // of evidence_.matches
};

// The pose at the place of the sighting.
struct FoundPose {
  Detection detection;
  std::size_t fit = 0;  // its index
};

// The most significant pose that overlaps the box.
std::optional<FoundPose> PoseAt(const Box& box, const FeatureSet& scene, const ObjectModel& model, std::size_t view,
                                std::size_t matches, std::size_t test_count, std::span<const PlanarFit> fits,
                                const DetectOptions& options) {
  DetectOptions all = options;
  all.min_score = 0;
  std::optional<FoundPose> best;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Candidate candidate{
        .view = view, .matches = matches, .views = test_count, .outline = model.views[view].outline, .fit = fits[i]};
    std::vector<Detection> found = Detect({&candidate, 1},
                                          {.width_px = static_cast<double>(scene.image_width),
                                           .height_px = static_cast<double>(scene.image_height),
                                           .searched_px2 = scene.SearchedBox().Area()},
                                          all);
    if (found.empty() || IntersectionOverUnion(found.front().box, box) < kMinOverlap) continue;
    if (best && best->detection.neg_log10_nfa >= found.front().neg_log10_nfa) continue;
    best = FoundPose{std::move(found.front()), i};
  }
  return best;
}

MatchEvidence GatherByGrammar(const FeatureSet& features, const ObjectModel& model, std::size_t view, const Box& box,
                              const RecognizeOptions& options) {
  const PreparedScene scene(features);
  const StagedMatches staged = MatchViewByGrammar(
      scene, model, view, {.match = options.match, .cascade = options.cascade, .pose = options.pose});
  const auto pose =
      PoseAt(box, features, model, view, staged.ratio.size(), model.views.size(), staged.fits, options.detect);
  StageList stages(features, model.ViewFeatures(view).keypoints);
  stages.Add(EvidenceStage::kRatioTest, staged.ratio);
  stages.Add(EvidenceStage::kFirstVoting, staged.cascade.first);
  stages.Add(EvidenceStage::kSecondVoting, staged.cascade.second);
  stages.Add(EvidenceStage::kThirdVoting, staged.cascade.third);
  stages.AddInliers(pose ? &staged.fits[pose->fit] : nullptr);
  MatchEvidence evidence = stages.Take();
  if (pose) evidence.detection = pose->detection;
  return evidence;
}

// One scene, one view: evidence by votes.
class VoteEvidence {
 public:
  VoteEvidence(const FeatureSet& features, const FrameConditions& conditions, const ObjectModel& model,
               const RelitTemplateSource* relit_templates, std::size_t view, const Box& box,
               const RecognizeOptions& options)
      : scene_(features, conditions.vertical),
        conditions_(conditions),
        model_(model),
        view_(view),
        box_(box),
        options_(options),
        has_sun_(relit_templates != nullptr && conditions.vertical && conditions.relative_sun),
        matcher_(model, relit_templates, scene_, options.search, options.pose, conditions.vertical) {}

  Expected<MatchEvidence> Gather() {
    VICTORIOUS_ASSIGN_OR_RETURN(MatchEvidence best, GatherInLight({}));
    if (!has_sun_ || !HasObservableHeading(model_.views[view_])) return best;
    const Eigen::Vector2d centre(box_.x + box_.width / 2, box_.y + box_.height / 2);
    VICTORIOUS_ASSIGN_OR_RETURN(MatchEvidence relit,
                                GatherInLight(matcher_.cells().CellCentre(conditions_.vertical->AzimuthAt(centre))));
    const auto significance = [](const MatchEvidence& one) {
      return one.detection ? one.detection->neg_log10_nfa : kNoPose;
    };
    if (significance(relit) <= significance(best)) return best;
    relit.is_relit = true;
    return relit;
  }

 private:
  // @param relative_azimuth_rad  of the cell that the templates are relit for; nullopt: diffuse light
  Expected<MatchEvidence> GatherInLight(std::optional<double> relative_azimuth_rad) {
    const TemplateVariant variant = VariantOf(view_, relative_azimuth_rad);
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MatchedTemplate> one, matcher_.Match({&variant, 1}));
    const MatchedTemplate& matched = one.front();
    const ComparedTemplate own = matched.Compared();
    const std::vector<PlanarFit> fits = matcher_.Vote(matched.variant, own);
    const auto pose = PoseOf(own, fits);
    if ((pose && *fits[pose->fit].neg_log10_nfa >= kInstanceNegLog10Nfa) || own.points_in_model.empty()) {
      return Stages(own, fits, pose);
    }
    std::vector<TemplateVariant> neighbours;
    for (const std::uint32_t neighbour : model_.views[view_].neighbours) {
      const ModelView& view = model_.views[neighbour];
      if (view.feature_count == 0 || (relative_azimuth_rad && !HasObservableHeading(view))) continue;
      neighbours.push_back(VariantOf(neighbour, relative_azimuth_rad));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<MatchedTemplate> beside, matcher_.Match(neighbours));
    std::vector<ComparedTemplate> compared;
    for (const MatchedTemplate& other : beside) compared.push_back(other.Compared());
    if (compared.empty()) return Stages(own, fits, pose);
    const PooledTemplate pool = PoolTemplates(own, compared);
    const ComparedTemplate pooled{pool.keypoints, pool.points_in_model, pool.matches};
    const std::vector<PlanarFit> pooled_fits = matcher_.Vote(matched.variant, pooled);
    const auto pooled_pose = PoseOf(pooled, pooled_fits);
    if (!pooled_pose || (pose && pose->detection.neg_log10_nfa >= pooled_pose->detection.neg_log10_nfa)) {
      return Stages(own, fits, pose);
    }
    MatchEvidence evidence = Stages(pooled, pooled_fits, pooled_pose);
    evidence.is_pooled = pooled.keypoints.size() > own.keypoints.size();
    return evidence;
  }

  TemplateVariant VariantOf(std::size_t view, std::optional<double> relative_azimuth_rad) const {
    if (!relative_azimuth_rad) return {.view = view, .sun_view = {}};
    return MakeRelitVariant(model_, view, *relative_azimuth_rad, *conditions_.relative_sun,
                            options_.search.sun_step_rad);
  }

  std::optional<FoundPose> PoseOf(const ComparedTemplate& compared, std::span<const PlanarFit> fits) const {
    return PoseAt(box_, scene_.features(), model_, view_, compared.matches.size(),
                  model_.views.size() * (has_sun_ ? 2 : 1), fits, options_.detect);
  }

  MatchEvidence Stages(const ComparedTemplate& compared, std::span<const PlanarFit> fits,
                       const std::optional<FoundPose>& pose) const {
    StageList stages(scene_.features(), compared.keypoints);
    stages.Add(EvidenceStage::kRankedMatches, compared.matches);
    stages.Add(EvidenceStage::kPoseVotes, pose ? VotesFor(fits[pose->fit], compared) : std::vector<RankedMatch>());
    stages.AddInliers(pose ? &fits[pose->fit] : nullptr);
    MatchEvidence evidence = stages.Take();
    if (pose) evidence.detection = pose->detection;
    return evidence;
  }

  // The matches that vote for a pose (search/pose/vote_poses.h), and its inliers: near the pose a keypoint's place
  // counts more than its own vote, so a few inliers vote beside it.
  std::vector<RankedMatch> VotesFor(const PlanarFit& fit, const ComparedTemplate& compared) const {
    std::set<MatchKey> inliers;
    for (const FitInlier& one : fit.inliers) inliers.insert(KeyOf(one.scene_keypoint, one.keypoint_in_template));
    const Similarity2& map = fit.scene_from_template;
    const Box bounds = BoundingBox(model_.views[view_].outline);
    const Eigen::Vector2d centre(bounds.x + bounds.width / 2, bounds.y + bounds.height / 2);
    const double reach_px = kCentreFraction * std::hypot(bounds.width, bounds.height) * map.scale;
    std::vector<RankedMatch> votes;
    for (const RankedMatch& match : compared.matches) {
      const Keypoint& s = scene_.features().keypoints[match.scene_keypoint];
      const Keypoint& m = compared.keypoints[match.template_keypoint];
      const Similarity2 own{static_cast<double>(s.scale_px) / m.scale_px,
                            WrapAngle(static_cast<double>(s.orientation_rad) - m.orientation_rad),
                            {s.x, s.y}};
      const Eigen::Vector2d place = own.Apply(centre - Eigen::Vector2d(m.x, m.y));
      const bool agrees = std::abs(std::log(own.scale / map.scale)) <= std::log(kVoteScaleFactor) &&
                          std::abs(WrapAngle(own.rotation_rad - map.rotation_rad)) <= options_.search.votes.turn_rad &&
                          (place - map.Apply(centre)).norm() <= reach_px;
      if (agrees || inliers.contains(KeyOf(match.scene_keypoint, m))) votes.push_back(match);
    }
    return votes;
  }

  PreparedScene scene_;
  const FrameConditions& conditions_;
  const ObjectModel& model_;
  std::size_t view_;
  const Box& box_;
  const RecognizeOptions& options_;
  bool has_sun_;
  TemplateMatcher matcher_;
};

}  // namespace

Expected<MatchEvidence> GatherEvidence(const FeatureSet& scene, const FrameConditions& conditions,
                                       const ObjectModel& model, const RelitTemplateSource* relit_templates,
                                       std::size_t view, const Box& box, const RecognizeOptions& options) {
  if (view >= model.views.size()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("model {}: has {} views, not view {}", model.name, model.views.size(), view));
  }
  // No default: a new method must say what explains its sightings.
  switch (MethodFor(model, options.method)) {
    case SearchMethod::kGrammar:
      return GatherByGrammar(scene, model, view, box, options);
    case SearchMethod::kVotes:
    case SearchMethod::kShortlist:  // its templates are found by proposals, their poses by the same votes
      return VoteEvidence(scene, conditions, model, relit_templates, view, box, options).Gather();
    case SearchMethod::kAuto:  // MethodFor returns another one
      break;
  }
  VICTORIOUS_CHECK(false);
}

}  // namespace victorious
