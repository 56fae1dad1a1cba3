#include "victorious/search/recognize/sun_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"
#include "victorious/search/recognize/model_matcher.h"
#include "victorious/search/recognize/template_proposals.h"
#include "victorious/search/recognize/template_variant.h"

namespace victorious {
namespace {

// The coarse grid (ADR 0010): a template matches up to about half of its spacing away from its sun.
constexpr int kCoarseAzimuths = 8;
constexpr double kCoarseElevation_rad = kPi / 4;
// The fine grid: the spacing of the views that quantise the sun's direction (`model add` makes one every 10 degrees),
// as far as the next coarse azimuth and over the elevations from 15 to 65 degrees.
constexpr double kFineStep_deg = 10;
constexpr int kFineAzimuthSteps = 3;        // on each side
constexpr int kFineElevationStepsDown = 3;  // below the coarse elevation
constexpr int kFineElevationStepsUp = 2;    // above it
// Views per frame that are matched in full: those of the most significant proposals under diffuse light, of all models.
constexpr std::size_t kMaxMatchedViews = 24;
// Of them, views that are relit: those of the highest -log10 NFA. Bounds the time.
constexpr std::size_t kMaxSunViews = 8;
// Relit templates of each grid that are made at full resolution and matched in full: those of the most significant
// proposals at half resolution.
constexpr std::size_t kMaxMatchedSuns = 12;
constexpr double kMinMatchedSunNegLog10Nfa = -1;  // of the proposals of the coarse grid
// Scene keypoints per template keypoint in proposals, as in ShortlistOptions.
constexpr int kNearestOfProposals = 2;
// Minimum -log10 NFA of a pose whose shading determines the sun's direction: that of a certain instance (vote_poses.h).
constexpr double kMinSunNegLog10Nfa = 6.0;
// A sun must explain the scene better than diffuse light by a factor of ten in the NFA.
constexpr double kMinGainOverDiffuse_decades = 1;

// A template of a model, and the -log10 NFA of its best pose.
struct RatedTemplate {
  std::size_t model;  // index into the models
  TemplateVariant variant;
  double neg_log10_nfa;  // kNoPose without a pose
};

// Keeps those of the highest -log10 NFA, sorted.
void KeepBest(std::size_t max_count, std::vector<RatedTemplate>& rated) {
  std::ranges::stable_sort(rated, std::greater{}, &RatedTemplate::neg_log10_nfa);
  rated.resize(std::min(rated.size(), max_count));
}

std::set<std::size_t> ViewsOf(std::span<const RatedTemplate> rated) {
  std::set<std::size_t> views;
  for (const RatedTemplate& one : rated) views.insert(one.variant.view);
  return views;
}

class SunEstimator {
 public:
  SunEstimator(std::span<const RelightableModel> models, const PreparedScene& scene, const Vertical& vertical,
               const VoteSearchOptions& options, const PoseOptions& pose_options)
      : models_(models), scene_(scene), vertical_(vertical), options_(options), pose_options_(pose_options) {}

  Expected<std::optional<SunEstimate>> Estimate() const {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<RatedTemplate> diffuse, FindViews());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<RatedTemplate> lit, FindSuns(diffuse));
    for (const RatedTemplate& one : lit) {
      double best_diffuse = 0;  // of that model; a chance pose has 0
      for (const RatedTemplate& other : diffuse) {
        if (other.model == one.model) best_diffuse = std::max(best_diffuse, other.neg_log10_nfa);
      }
      const double gain_decades = one.neg_log10_nfa - best_diffuse;
      if (one.neg_log10_nfa < kMinSunNegLog10Nfa || gain_decades < kMinGainOverDiffuse_decades) continue;
      return EstimateFromTemplate(one, gain_decades);
    }
    return std::nullopt;
  }

 private:
  // The oblique coarse views that an upright object can show, of the highest -log10 NFA under diffuse light.
  Expected<std::vector<RatedTemplate>> FindViews() const {
    std::vector<RatedTemplate> found;
    for (std::size_t m = 0; m < models_.size(); ++m) {
      const ObjectModel& model = *models_[m].model;
      const AzimuthCells cells = MakeMatcher(models_[m]).cells();
      std::vector<TemplateVariant> variants;
      for (const std::size_t view : ChooseCoarseViews(model, ChooseViews(model, cells, options_.max_tilt_rad))) {
        if (HasObservableHeading(model.views[view])) variants.push_back({.view = view, .sun_view = {}});
      }
      const std::size_t first = found.size();
      VICTORIOUS_RETURN_IF_ERROR(AppendProposals(m, variants, found));
      const std::set<std::size_t> proposed = ViewsOf(std::span(found).subspan(first));
      for (const TemplateVariant& one : variants) {  // also without a pose: direct sun may hide all diffuse features
        if (!proposed.contains(one.view)) found.push_back({m, one, kNoPose});
      }
    }
    KeepBest(kMaxMatchedViews, found);
    VICTORIOUS_RETURN_IF_ERROR(MatchInFull(found));
    KeepBest(kMaxSunViews, found);
    return found;
  }

  // The views relit by suns of the coarse grid, of the highest -log10 NFA.
  Expected<std::vector<RatedTemplate>> FindSuns(const std::vector<RatedTemplate>& views) const {
    std::vector<RatedTemplate> found;
    for (std::size_t m = 0; m < models_.size(); ++m) {
      std::vector<TemplateVariant> variants;
      for (const RatedTemplate& one : views) {
        if (one.model != m) continue;
        for (int i = 0; i < kCoarseAzimuths; ++i) {
          const std::size_t sun_view =
              NearestViewToSun(*models_[m].model, 2 * kPi * i / kCoarseAzimuths, kCoarseElevation_rad);
          variants.push_back({.view = one.variant.view, .sun_view = sun_view, .half_resolution = true});
        }
      }
      VICTORIOUS_RETURN_IF_ERROR(AppendProposals(m, variants, found));
    }
    std::erase_if(found, [](const RatedTemplate& one) { return one.neg_log10_nfa < kMinMatchedSunNegLog10Nfa; });
    KeepBest(kMaxMatchedSuns, found);
    for (RatedTemplate& one : found) one.variant.half_resolution = false;
    VICTORIOUS_RETURN_IF_ERROR(MatchInFull(found));
    KeepBest(kMaxMatchedSuns, found);
    return found;
  }

  // Appends templates of a model with the approximate -log10 NFA of their proposals, if they have one.
  Status AppendProposals(std::size_t m, std::span<const TemplateVariant> variants,
                         std::vector<RatedTemplate>& rated) const {
    if (variants.empty()) return {};
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::vector<TemplateProposal> proposals,
        ProposeTemplates(*models_[m].shortened, models_[m].relit_templates, scene_, MakeMatcher(models_[m]).cells(),
                         options_, variants, kNearestOfProposals));
    for (const TemplateProposal& one : proposals) rated.push_back({m, one.variant, one.pose.neg_log10_nfa});
    return {};
  }

  // Replaces the approximate -log10 NFA by that of the poses.
  Status MatchInFull(std::vector<RatedTemplate>& rated) const {
    for (std::size_t m = 0; m < models_.size(); ++m) {
      std::vector<TemplateVariant> variants;
      for (const RatedTemplate& one : rated) {
        if (one.model == m) variants.push_back(one.variant);
      }
      if (variants.empty()) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, MakeMatcher(models_[m]).Evaluate(variants));
      std::size_t next = 0;
      for (RatedTemplate& one : rated) {
        if (one.model == m) one.neg_log10_nfa = neg_log10_nfa[next++];
      }
    }
    return {};
  }

  Expected<std::optional<SunEstimate>> EstimateFromTemplate(const RatedTemplate& found, double gain_decades) const {
    const ObjectModel& model = *models_[found.model].model;
    const std::size_t view = found.variant.view;
    ModelMatcher matcher = MakeMatcher(models_[found.model]);
    VICTORIOUS_ASSIGN_OR_RETURN(const Eigen::Vector3d mean, RefineDirection(found, matcher));
    // From the object's line of sight to the viewing direction through the image centre.
    const std::vector<Candidate> poses = matcher.TakeCandidates();
    if (poses.empty()) return std::nullopt;
    const Candidate& best_pose =
        *std::ranges::max_element(poses, {}, [](const Candidate& pose) { return *pose.fit.neg_log10_nfa; });
    const double relative_azimuth_rad = vertical_->AzimuthAt(ObjectCentre(best_pose.fit, best_pose.outline));
    const double azimuth_rad =
        RelativeSunAzimuth(model.views[view].angles->azimuth_rad, std::atan2(mean.y(), mean.x()));
    const Sun relative_sun{.azimuth_rad = WrapAngle(azimuth_rad + relative_azimuth_rad),
                           .elevation_rad = std::atan2(mean.z(), std::hypot(mean.x(), mean.y()))};
    return SunEstimate{relative_sun, gain_decades};
  }

  // The mean of the sun directions on the fine grid, weighted by 1 / NFA relative to the best of the coarse grid. In
  // the model frame, azimuth as ViewDirection; not of unit length. Those that are not among the best proposals at half
  // resolution have no weight.
  Expected<Eigen::Vector3d> RefineDirection(const RatedTemplate& coarse, ModelMatcher& matcher) const {
    const ObjectModel& model = *models_[coarse.model].model;
    const double coarse_azimuth_rad = model.views[*coarse.variant.sun_view].angles->azimuth_rad;
    std::vector<TemplateVariant> variants;
    std::map<std::size_t, Eigen::Vector3d> directions;  // by the view that quantises them: their sum
    for (int around = -kFineAzimuthSteps; around <= kFineAzimuthSteps; ++around) {
      for (int up = -kFineElevationStepsDown; up <= kFineElevationStepsUp; ++up) {
        const double azimuth_rad = coarse_azimuth_rad + RadiansFromDegrees(kFineStep_deg * around);
        const double elevation_rad = kCoarseElevation_rad + RadiansFromDegrees(kFineStep_deg * up);
        const std::size_t sun_view = NearestViewToSun(model, azimuth_rad, elevation_rad);
        const auto [sum, is_new] = directions.try_emplace(sun_view, Eigen::Vector3d::Zero());
        if (is_new) variants.push_back({.view = coarse.variant.view, .sun_view = sun_view, .half_resolution = true});
        sum->second += Eigen::Vector3d(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                       std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
      }
    }
    std::vector<RatedTemplate> fine;
    VICTORIOUS_RETURN_IF_ERROR(AppendProposals(coarse.model, variants, fine));
    KeepBest(kMaxMatchedSuns, fine);
    variants.clear();
    for (const RatedTemplate& one : fine)
      variants.push_back({.view = one.variant.view, .sun_view = one.variant.sun_view});
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, matcher.Evaluate(variants));
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < variants.size(); ++i) {
      mean += std::pow(10.0, neg_log10_nfa[i] - coarse.neg_log10_nfa) * directions.at(*variants[i].sun_view);
    }
    return mean;
  }

  [[nodiscard]] ModelMatcher MakeMatcher(const RelightableModel& relightable) const {
    constexpr std::size_t kTestCount = 1;  // of the candidates, which are not used
    return {*relightable.model, relightable.relit_templates, scene_, options_, pose_options_, vertical_, kTestCount};
  }

  std::span<const RelightableModel> models_;
  const PreparedScene& scene_;
  std::optional<Vertical> vertical_;
  const VoteSearchOptions& options_;
  const PoseOptions& pose_options_;
};

}  // namespace

Expected<std::optional<SunEstimate>> EstimateSun(std::span<const RelightableModel> models, const PreparedScene& scene,
                                                 const Vertical& vertical, const VoteSearchOptions& options,
                                                 const PoseOptions& pose_options) {
  return SunEstimator(models, scene, vertical, options, pose_options).Estimate();
}

}  // namespace victorious
