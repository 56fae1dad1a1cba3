#include "victorious/recognize/sun_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/angles.h"
#include "victorious/recognize/model_matcher.h"
#include "victorious/recognize/template_variant.h"

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
// Views per frame that are relit: those of the highest -log10 NFA under diffuse light. Bounds the time.
constexpr std::size_t kMaxSunViews = 8;
// Minimum -log10 NFA of a pose whose shading determines the sun's direction: that of a certain instance (vote_poses.h).
constexpr double kMinSunNegLog10Nfa = 6.0;
// A sun must explain the scene better than diffuse light by a factor of ten in the NFA.
constexpr double kMinGainOverDiffuse_decades = 1;

// A view whose shading in the scene may determine the sun's direction.
struct SunCandidateView {
  std::size_t model;  // index into the models
  std::size_t view;
  double neg_log10_nfa;  // of its best pose under diffuse light; kNoPose without a pose
};

class SunEstimator {
 public:
  SunEstimator(std::span<const RelightableModel> models, const PreparedScene& scene, const Vertical& vertical,
               const VoteSearchOptions& options, const PoseOptions& pose_options)
      : models_(models), scene_(scene), vertical_(vertical), options_(options), pose_options_(pose_options) {}

  Expected<std::optional<SunEstimate>> Estimate() const {
    std::vector<SunCandidateView> candidates;
    for (std::size_t m = 0; m < models_.size(); ++m) VICTORIOUS_RETURN_IF_ERROR(AppendCandidateViews(m, candidates));
    std::ranges::stable_sort(candidates, std::greater{}, &SunCandidateView::neg_log10_nfa);
    candidates.resize(std::min(candidates.size(), kMaxSunViews));
    std::optional<SunEstimate> best;
    for (std::size_t m = 0; m < models_.size(); ++m) {
      std::vector<SunCandidateView> own;
      for (const SunCandidateView& candidate : candidates) {
        if (candidate.model == m) own.push_back(candidate);
      }
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SunEstimate> found, EstimateFromModel(models_[m], own));
      if (found && (!best || found->neg_log10_nfa > best->neg_log10_nfa)) best = found;
    }
    return best;
  }

 private:
  // Appends the oblique coarse views that an upright object can show, with their -log10 NFA under diffuse light.
  Status AppendCandidateViews(std::size_t m, std::vector<SunCandidateView>& candidates) const {
    const ObjectModel& model = *models_[m].model;
    const AzimuthCells cells = MakeMatcher(models_[m], 0).cells();
    std::vector<TemplateVariant> variants;
    for (const std::size_t view : ChooseCoarseViews(model, ChooseViews(model, cells, options_.max_tilt_rad))) {
      if (HasObservableHeading(model.views[view])) variants.push_back({.view = view, .sun_view = {}});
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa,
                                MakeMatcher(models_[m], variants.size()).Evaluate(variants));
    for (std::size_t i = 0; i < variants.size(); ++i) candidates.push_back({m, variants[i].view, neg_log10_nfa[i]});
    return {};
  }

  Expected<std::optional<SunEstimate>> EstimateFromModel(const RelightableModel& relightable,
                                                         std::span<const SunCandidateView> candidates) const {
    if (candidates.empty()) return std::nullopt;
    const ObjectModel& model = *relightable.model;
    std::vector<TemplateVariant> coarse;
    for (const SunCandidateView& candidate : candidates) {
      for (int i = 0; i < kCoarseAzimuths; ++i) {
        coarse.push_back(
            {candidate.view, NearestViewToSun(model, 2 * kPi * i / kCoarseAzimuths, kCoarseElevation_rad)});
      }
    }
    ModelMatcher matcher = MakeMatcher(relightable, coarse.size());
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, matcher.Evaluate(coarse));
    const auto best = static_cast<std::size_t>(std::ranges::max_element(neg_log10_nfa) - neg_log10_nfa.begin());
    const double diffuse = std::ranges::max(candidates, {}, &SunCandidateView::neg_log10_nfa).neg_log10_nfa;
    if (neg_log10_nfa[best] < std::max(kMinSunNegLog10Nfa, diffuse + kMinGainOverDiffuse_decades)) return std::nullopt;

    const std::size_t view = coarse[best].view;
    VICTORIOUS_ASSIGN_OR_RETURN(const Eigen::Vector3d mean,
                                RefineDirection(model, view, model.views[*coarse[best].sun_view].angles->azimuth_rad,
                                                neg_log10_nfa[best], matcher));
    // From the object's line of sight to the viewing direction through the image centre.
    const std::vector<Candidate> poses = matcher.TakeCandidates();
    const Candidate& best_pose =
        *std::ranges::max_element(poses, {}, [](const Candidate& pose) { return *pose.fit.neg_log10_nfa; });
    const double relative_azimuth_rad = vertical_->AzimuthAt(ObjectCentre(best_pose.fit, best_pose.outline));
    const double azimuth_rad =
        RelativeSunAzimuth(model.views[view].angles->azimuth_rad, std::atan2(mean.y(), mean.x()));
    const Sun relative_sun{.azimuth_rad = WrapAngle(azimuth_rad + relative_azimuth_rad),
                           .elevation_rad = std::atan2(mean.z(), std::hypot(mean.x(), mean.y()))};
    return SunEstimate{relative_sun, neg_log10_nfa[best]};
  }

  // The mean of the sun directions on the fine grid, weighted by 1 / NFA relative to the best of the coarse grid. In
  // the model frame, azimuth as ViewAngles; not of unit length.
  Expected<Eigen::Vector3d> RefineDirection(const ObjectModel& model, std::size_t view, double coarse_azimuth_rad,
                                            double coarse_neg_log10_nfa, ModelMatcher& matcher) const {
    std::vector<TemplateVariant> fine;
    std::vector<Eigen::Vector3d> directions;
    for (int around = -kFineAzimuthSteps; around <= kFineAzimuthSteps; ++around) {
      for (int up = -kFineElevationStepsDown; up <= kFineElevationStepsUp; ++up) {
        const double azimuth_rad = coarse_azimuth_rad + RadiansFromDegrees(kFineStep_deg * around);
        const double elevation_rad = kCoarseElevation_rad + RadiansFromDegrees(kFineStep_deg * up);
        fine.push_back({view, NearestViewToSun(model, azimuth_rad, elevation_rad)});
        directions.emplace_back(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
      }
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<double> neg_log10_nfa, matcher.Evaluate(fine));
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < directions.size(); ++i) {
      mean += std::pow(10.0, neg_log10_nfa[i] - coarse_neg_log10_nfa) * directions[i];
    }
    return mean;
  }

  [[nodiscard]] ModelMatcher MakeMatcher(const RelightableModel& relightable, std::size_t test_count) const {
    return {*relightable.model, relightable.relit_templates, scene_, options_, pose_options_, vertical_, test_count};
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
