#include "victorious/recognize/vote_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <ranges>
#include <set>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/homography.h"
#include "victorious/geometry/polygon.h"
#include "victorious/kernels/nearest.h"
#include "victorious/pose/pooled_template.h"
#include "victorious/recognize/azimuth_cells.h"

namespace victorious {

void VoteSearchOptions::ListFields(FieldList& fields) {
  fields.Add("nearest", nearest,
             {.min = 1,
              .max = static_cast<double>(kernels::kMaxNeighbours),
              .reason = "ranked matches per template keypoint: its nearest scene keypoints"});
  fields.Add("max_refined_views", max_refined_views,
             {.min = 0,
              .max = 100000,
              .reason = "coarse views whose neighbours are matched, too: those of the highest -log10 NFA"});
  fields.Add("max_pooled_views", max_pooled_views,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "views of the highest -log10 NFA that vote once more together with the matches of their "
                        "neighbours: an object seen from between two views matches keypoints of both"});
  fields.Add("max_relit_views", max_relit_views,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "coarse views that are also matched relit by the sun: those of the highest -log10 NFA under "
                        "diffuse light; by default all, since direct sun may hide features of diffuse light"});
  fields.Add("max_tilt_rad", max_tilt_rad,
             {.min = 0.01,
              .max = 3.2,
              .unit = "rad",
              .reason = "with known camera attitude: maximum angle between an object's up axis and the vertical, the "
                        "angular step between views included; 3.2 allows any attitude of the object"});
  fields.Add(
      "max_hanging_rad", max_hanging_rad,
      {.min = 0,
       .max = kPi / 2,
       .unit = "rad",
       .reason = "with unknown camera attitude: maximum angle of an object's up axis below the image's horizontal; "
                 "pi/2 for a camera that may be upside down"});
  fields.Add("sun_step_rad", sun_step_rad,
             {.min = 0.05,
              .max = 3.2,
              .unit = "rad",
              .reason = "quantisation step of the sun's azimuth for relit templates; finer is more accurate, and needs "
                        "more renderings and memory"});
  fields.Add("min_sun_neg_log10_nfa", min_sun_neg_log10_nfa,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "minimum -log10 NFA of a pose whose shading determines the sun's direction"});
  fields.Add("max_sun_views", max_sun_views,
             {.min = 1,
              .max = 100000,
              .unit = "views",
              .reason = "views per frame that are tested for the sun's direction: those of the highest -log10 NFA "
                        "under diffuse light; each is relit by eight suns"});
  fields.AddGroup("votes", votes);
}

namespace {

constexpr double kNoPose = -std::numeric_limits<double>::infinity();

// A template to match: a view under diffuse light, or relit by a sun in the direction of another view's camera.
struct TemplateVariant {
  std::size_t view;
  std::optional<std::size_t> sun_view;  // nullopt: diffuse light
  std::optional<double> relative_azimuth_rad =
      {};                        // centre of the azimuth cell that this sun is valid for; nullopt: any
  bool half_resolution = false;  // half resolution, as in RelitTemplateKey
};

// For each view: true if the scene may show it: it has features, and its off-nadir angle fits the lines of sight.
std::vector<bool> ChooseViews(const ObjectModel& model, const AzimuthCells& cells, double max_tilt_rad) {
  const auto [min_rad, max_rad] = cells.OffNadirRange();
  std::vector<bool> chosen;
  for (const ModelView& view : model.views) {
    const bool fits = !view.angles || (view.angles->off_nadir_rad >= min_rad - max_tilt_rad &&
                                       view.angles->off_nadir_rad <= max_rad + max_tilt_rad);
    chosen.push_back(fits && view.feature_count > 0);
  }
  return chosen;
}

// The coarse views: a maximal independent set of the chosen views in the neighbour graph (greedy). Every chosen view is
// a coarse view or the neighbour of one.
std::vector<std::size_t> ChooseCoarseViews(const ObjectModel& model, const std::vector<bool>& chosen) {
  std::vector<std::size_t> coarse_views;
  std::vector<bool> covered(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    if (covered[view] || !chosen[view]) continue;
    coarse_views.push_back(view);
    for (const std::uint32_t neighbour : model.views[view].neighbours) covered[neighbour] = true;
  }
  return coarse_views;
}

// The centre of the object's box in the scene, px.
Eigen::Vector2d ObjectCentre(const PlanarFit& fit, const Polygon& outline) {
  const Box box = BoundingBox(ProjectPolygon(fit.scene_from_template_plane, outline));
  return {box.x + box.width / 2, box.y + box.height / 2};
}

// The view whose camera direction is nearest to the sun's direction: quantises the sun.
// @param azimuth_rad  of the sun in the model frame, as ViewAngles::azimuth_rad
std::size_t NearestViewToSun(const ObjectModel& model, double azimuth_rad, double elevation_rad) {
  const auto closeness = [&](const ModelView& view) {
    const ViewAngles& angles = *view.angles;
    return std::cos(angles.off_nadir_rad) * std::sin(elevation_rad) +
           std::sin(angles.off_nadir_rad) * std::cos(elevation_rad) * std::cos(angles.azimuth_rad - azimuth_rad);
  };
  return static_cast<std::size_t>(std::ranges::max_element(model.views, {}, closeness) - model.views.begin());
}

// True if the view is oblique enough to determine the object's heading, and with it the sun in the model frame.
bool HasObservableHeading(const ModelView& view) {
  constexpr double kMinOffNadir_rad = 0.3;
  return view.angles && view.angles->off_nadir_rad >= kMinOffNadir_rad;
}

// Converts the sun's azimuth between the viewing direction (relative) and the model frame (as ViewAngles::azimuth_rad),
// for an object seen from view_azimuth_rad.
double SunAzimuthInModel(double view_azimuth_rad, double relative_sun_azimuth_rad) {
  return view_azimuth_rad + kPi + relative_sun_azimuth_rad;
}
double RelativeSunAzimuth(double view_azimuth_rad, double sun_in_model_rad) {
  return WrapAngle(sun_in_model_rad - view_azimuth_rad - kPi);
}

// The relit template of a view for an azimuth cell: the sun's azimuth in the model's frame, quantised to sun_step_rad.
// @param sun  relative to the viewing direction through the image centre
TemplateVariant MakeRelitVariant(const ObjectModel& model, std::size_t view, double relative_azimuth_rad,
                                 const Sun& sun, double sun_step_rad) {
  const double azimuth_rad =
      SunAzimuthInModel(model.views[view].angles->azimuth_rad, sun.azimuth_rad - relative_azimuth_rad);
  const double shared_rad = sun_step_rad * std::round(azimuth_rad / sun_step_rad);
  return {.view = view,
          .sun_view = NearestViewToSun(model, shared_rad, sun.elevation_rad),
          .relative_azimuth_rad = relative_azimuth_rad};
}

// A matched template and the highest -log10 NFA of its poses.
struct ScoredVariant {
  TemplateVariant variant;
  double neg_log10_nfa;
};

std::vector<ScoredVariant> SortedByNfa(std::vector<ScoredVariant> scored) {
  std::ranges::stable_sort(scored, std::greater{}, &ScoredVariant::neg_log10_nfa);
  return scored;
}

// Matches templates of one model with one scene and collects the poses.
class ModelMatcher {
 public:
  ModelMatcher(const ObjectModel& model, const RelitTemplateSource* lit, const PreparedScene& scene,
               const std::optional<Vertical>& vertical, std::size_t variants)
      : model_(model),
        relit_templates_(lit),
        scene_(scene),
        vertical_(vertical),
        test_count_(variants),
        cells_(vertical, scene.features.SearchedBox(), 2 * scene.options.sun_step_rad) {}

  // The azimuth cells of the searched region.
  [[nodiscard]] const AzimuthCells& cells() const { return cells_; }

  // Matches templates; returns the highest -log10 NFA of each, minus infinity without a pose.
  std::vector<double> Evaluate(std::span<const TemplateVariant> variants) {
    std::vector<RelitTemplateKey> needed;
    for (const TemplateVariant& variant : variants) {
      if (variant.sun_view) needed.push_back({*variant.sun_view, variant.view, variant.half_resolution});
    }
    if (!needed.empty()) relit_templates_->Prepare(needed);
    std::vector<double> neg_log10_nfa;
    for (const TemplateVariant& variant : variants) neg_log10_nfa.push_back(Evaluate(variant));
    return neg_log10_nfa;
  }

  std::vector<ScoredVariant> EvaluateScored(std::span<const TemplateVariant> variants) {
    const std::vector<double> neg_log10_nfa = Evaluate(variants);
    std::vector<ScoredVariant> scored;
    for (std::size_t i = 0; i < variants.size(); ++i) scored.push_back({variants[i], neg_log10_nfa[i]});
    return scored;
  }

  // Pools each of the best templates with the matched neighbours of the same light and votes again.
  void Pool(int most) {
    std::vector<std::size_t> order(matched_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Half resolution is left out: the good ones have been matched at full resolution, too.
    std::erase_if(order, [&](std::size_t i) { return matched_[i].variant.half_resolution; });
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return matched_[i].neg_log10_nfa; });
    for (const std::size_t i : order | std::views::take(most)) {
      const MatchedVariant& one = matched_[i];
      if (one.neg_log10_nfa == kNoPose) break;
      if (one.neg_log10_nfa >= scene_.options.votes.instance_neg_log10_nfa) continue;  // already certain
      std::vector<ComparedTemplate> beside;
      for (const MatchedVariant& other : matched_) {
        if (AreNeighbours(one.variant, other.variant)) beside.push_back(TemplateOf(other));
      }
      if (beside.empty() || SurfacePointsOf(one).empty()) continue;
      const PooledTemplate pooled = victorious::PoolTemplates(TemplateOf(one), beside);
      Vote(one.variant, pooled.keypoints, pooled.points_in_model, pooled.matches);
    }
  }

  std::vector<Candidate> TakeCandidates() { return std::move(candidates_); }

 private:
  // A matched template and its results.
  struct MatchedVariant {
    TemplateVariant variant;
    std::shared_ptr<const RelitTemplate> lit;  // null: diffuse light
    std::vector<RankedMatch> matches;
    double neg_log10_nfa = kNoPose;
  };

  double Evaluate(const TemplateVariant& variant) {
    MatchedVariant matched{.variant = variant, .lit = {}, .matches = {}};
    if (variant.sun_view)
      matched.lit = relit_templates_->GetTemplate({*variant.sun_view, variant.view, variant.half_resolution});
    const FeatureView features = FeaturesOf(matched);
    matched.matches = scene_.ranked.Match(kernels::PackQueries(features.descriptors), scene_.options.nearest);
    matched.neg_log10_nfa = Vote(variant, features.keypoints, SurfacePointsOf(matched), matched.matches);
    matched_.push_back(std::move(matched));
    return matched_.back().neg_log10_nfa;
  }

  // Adds the poses of a template's keypoints to the candidates; returns their highest -log10 NFA.
  double Vote(const TemplateVariant& variant, std::span<const Keypoint> keypoints, std::span<const Point3> points,
              std::span<const RankedMatch> matches) {
    const ModelView& view = model_.views[variant.view];
    std::optional<UprightPrior> upright;
    if (view.angles) {
      const double off_nadir_rad = view.angles->off_nadir_rad;
      upright = vertical_ ? UprightPrior::FromVertical(*vertical_, off_nadir_rad, scene_.options.max_tilt_rad)
                          : UprightPrior::AssumingUprightCamera(off_nadir_rad, scene_.options.max_hanging_rad);
    }
    double max_neg_log10_nfa = kNoPose;
    for (PlanarFit& fit :
         VotePoses(scene_.features, keypoints, matches, view.outline, scene_.options.votes, scene_.fit, upright)) {
      if (!HasSunOfItsCell(variant, fit)) continue;
      max_neg_log10_nfa = std::max(max_neg_log10_nfa, *fit.neg_log10_nfa);
      if (!points.empty()) {
        for (const Match& match : fit.inliers) fit.inlier_points.push_back(points[match.template_keypoint]);
      }
      candidates_.push_back({.view = variant.view,
                             .matches = matches.size(),
                             .views = test_count_,
                             .outline = view.outline,
                             .fit = std::move(fit)});
    }
    return max_neg_log10_nfa;
  }

  // True if the pose lies in the azimuth cell that the template was relit for: each position has one sun.
  [[nodiscard]] bool HasSunOfItsCell(const TemplateVariant& variant, const PlanarFit& fit) const {
    if (!variant.relative_azimuth_rad) return true;
    const double relative_azimuth_rad = vertical_->AzimuthAt(ObjectCentre(fit, model_.views[variant.view].outline));
    return cells_.CellCentre(relative_azimuth_rad) == *variant.relative_azimuth_rad;
  }

  [[nodiscard]] bool AreNeighbours(const TemplateVariant& one, const TemplateVariant& other) const {
    const std::vector<std::uint32_t>& neighbours = model_.views[one.view].neighbours;
    return one.sun_view.has_value() == other.sun_view.has_value() &&
           one.relative_azimuth_rad == other.relative_azimuth_rad && one.half_resolution == other.half_resolution &&
           std::ranges::find(neighbours, other.view) != neighbours.end();
  }

  [[nodiscard]] FeatureView FeaturesOf(const MatchedVariant& matched) const {
    return matched.lit ? matched.lit->features.View() : model_.ViewFeatures(matched.variant.view);
  }

  [[nodiscard]] std::span<const Point3> SurfacePointsOf(const MatchedVariant& matched) const {
    if (matched.lit) return matched.lit->points_in_model;
    if (model_.points_in_model.empty()) return {};
    const ModelView& view = model_.views[matched.variant.view];
    return model_.points_in_model.subspan(view.first_feature, view.feature_count);
  }

  [[nodiscard]] ComparedTemplate TemplateOf(const MatchedVariant& matched) const {
    return {FeaturesOf(matched).keypoints, SurfacePointsOf(matched), matched.matches};
  }

  const ObjectModel& model_;
  const RelitTemplateSource* relit_templates_;
  const PreparedScene& scene_;
  const std::optional<Vertical>& vertical_;
  std::size_t test_count_;
  AzimuthCells cells_;
  std::vector<MatchedVariant> matched_;
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<Candidate> VoteSearch::Search(const PreparedScene& scene, const FrameConditions& conditions) const {
  const VoteSearchOptions& options = scene.options;
  const bool has_sun = relit_templates_ && conditions.vertical && conditions.relative_sun;
  ModelMatcher matcher(*model_, relit_templates_.get(), scene, conditions.vertical,
                       model_->views.size() * (has_sun ? 2 : 1));

  const std::vector<bool> chosen = ChooseViews(*model_, matcher.cells(), options.max_tilt_rad);
  std::set<std::pair<std::size_t, std::optional<double>>>
      matched_cells;  // view and azimuth cell; nullopt: diffuse light
  const auto add_variant = [&](std::size_t view, std::optional<double> relative_azimuth_rad,
                               std::vector<TemplateVariant>& variants) {
    if (!chosen[view] || (relative_azimuth_rad && !HasObservableHeading(model_->views[view]))) return;
    if (!matched_cells.emplace(view, relative_azimuth_rad).second) return;
    variants.push_back(relative_azimuth_rad ? MakeRelitVariant(*model_, view, *relative_azimuth_rad,
                                                               *conditions.relative_sun, options.sun_step_rad)
                                            : TemplateVariant{.view = view, .sun_view = {}});
  };
  std::vector<TemplateVariant> diffuse;
  for (const std::size_t view : ChooseCoarseViews(*model_, chosen)) add_variant(view, {}, diffuse);
  std::vector<ScoredVariant> scored = matcher.EvaluateScored(diffuse);
  std::vector<TemplateVariant> lit;
  std::set<std::size_t> lit_views;
  for (const ScoredVariant& scored_variant :
       SortedByNfa(scored)) {  // also those without a pose: direct sun may hide all diffuse features
    const ModelView& view = model_->views[scored_variant.variant.view];
    if (!has_sun || std::ssize(lit_views) == options.max_relit_views) break;
    if (!HasObservableHeading(view)) continue;
    lit_views.insert(scored_variant.variant.view);
    for (const double relative_azimuth_rad :
         matcher.cells().CellCentresForView(view.angles->off_nadir_rad, options.max_tilt_rad)) {
      add_variant(scored_variant.variant.view, relative_azimuth_rad, lit);
    }
  }
  for (TemplateVariant& variant : lit) variant.half_resolution = true;
  std::ranges::copy(matcher.EvaluateScored(lit), std::back_inserter(scored));
  std::vector<TemplateVariant> refined_variants;
  for (const ScoredVariant& scored_variant : SortedByNfa(scored) | std::views::take(options.max_refined_views)) {
    if (scored_variant.neg_log10_nfa == kNoPose) break;
    if (scored_variant.variant.half_resolution) {  // again at full resolution, as its neighbours
      refined_variants.push_back(scored_variant.variant);
      refined_variants.back().half_resolution = false;
    }
    for (const std::uint32_t neighbour : model_->views[scored_variant.variant.view].neighbours) {
      add_variant(neighbour, scored_variant.variant.relative_azimuth_rad, refined_variants);
    }
  }
  matcher.Evaluate(refined_variants);
  matcher.Pool(options.max_pooled_views);
  return matcher.TakeCandidates();
}

std::vector<Candidate> VoteSearch::SearchViews(const PreparedScene& scene, const FrameConditions& conditions,
                                               std::span<const std::size_t> views) const {
  const VoteSearchOptions& options = scene.options;
  const bool has_sun = relit_templates_ && conditions.vertical && conditions.relative_sun;
  ModelMatcher matcher(*model_, relit_templates_.get(), scene, conditions.vertical, views.size() * (has_sun ? 2 : 1));
  std::vector<TemplateVariant> variants;
  for (const std::size_t number : views) {
    const ModelView& view = model_->views[number];
    if (view.feature_count == 0) continue;
    variants.push_back({.view = number, .sun_view = {}});
    if (!has_sun || !HasObservableHeading(view)) continue;
    for (const double relative_azimuth_rad :
         matcher.cells().CellCentresForView(view.angles->off_nadir_rad, options.max_tilt_rad)) {
      variants.push_back(
          MakeRelitVariant(*model_, number, relative_azimuth_rad, *conditions.relative_sun, options.sun_step_rad));
    }
  }
  matcher.Evaluate(variants);
  matcher.Pool(options.max_pooled_views);
  return matcher.TakeCandidates();
}

std::vector<SunCandidateView> VoteSearch::FindSunCandidateViews(const PreparedScene& scene,
                                                                const Vertical& vertical) const {
  if (!relit_templates_) return {};
  const AzimuthCells cells(vertical, scene.features.SearchedBox(), 2 * scene.options.sun_step_rad);
  std::vector<TemplateVariant> variants;
  for (const std::size_t view : ChooseCoarseViews(*model_, ChooseViews(*model_, cells, scene.options.max_tilt_rad))) {
    if (HasObservableHeading(model_->views[view])) variants.push_back({.view = view, .sun_view = {}});
  }
  const std::optional<Vertical> known = vertical;
  const std::vector<double> neg_log10_nfa =
      ModelMatcher(*model_, nullptr, scene, known, variants.size()).Evaluate(variants);
  std::vector<SunCandidateView> scored;
  for (std::size_t i = 0; i < variants.size(); ++i) scored.push_back({variants[i].view, neg_log10_nfa[i]});
  return scored;
}

std::optional<SunEstimate> VoteSearch::EstimateSun(const PreparedScene& scene, const Vertical& vertical,
                                                   std::span<const SunCandidateView> scored) const {
  if (!relit_templates_ || scored.empty()) return std::nullopt;
  constexpr int kAzimuths = 8;
  constexpr double kElevation_rad = kPi / 4;
  std::vector<TemplateVariant> lit;
  for (const SunCandidateView& scored_variant : scored) {
    for (int i = 0; i < kAzimuths; ++i) {
      lit.push_back({scored_variant.view, NearestViewToSun(*model_, 2 * kPi * i / kAzimuths, kElevation_rad)});
    }
  }
  const std::optional<Vertical> known = vertical;
  ModelMatcher matcher(*model_, relit_templates_.get(), scene, known, lit.size());
  const std::vector<double> neg_log10_nfa = matcher.Evaluate(lit);
  const auto best = static_cast<std::size_t>(std::ranges::max_element(neg_log10_nfa) - neg_log10_nfa.begin());
  const double diffuse = std::ranges::max(scored, {}, &SunCandidateView::neg_log10_nfa).neg_log10_nfa;
  if (neg_log10_nfa[best] < std::max(scene.options.min_sun_neg_log10_nfa, diffuse + 1)) return std::nullopt;

  // Refinement with the same view: the mean of the sun directions on a 10 degree grid, weighted by 1 / NFA.
  const std::size_t view = lit[best].view;
  const double first_rad = model_->views[*lit[best].sun_view].angles->azimuth_rad;
  std::vector<TemplateVariant> refined;
  std::vector<Eigen::Vector3d> suns;
  for (int around = -3; around <= 3; ++around) {
    for (int up = -3; up <= 2; ++up) {
      const double azimuth_rad = first_rad + RadiansFromDegrees(10.0 * around);
      const double elevation_rad = kElevation_rad + RadiansFromDegrees(10.0 * up);
      refined.push_back({view, NearestViewToSun(*model_, azimuth_rad, elevation_rad)});
      suns.emplace_back(std::cos(elevation_rad) * std::cos(azimuth_rad),
                        std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
    }
  }
  const std::vector<double> refined_neg_log10_nfa = matcher.Evaluate(refined);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < suns.size(); ++i)
    mean += std::pow(10.0, refined_neg_log10_nfa[i] - neg_log10_nfa[best]) * suns[i];
  // From the object's line of sight to the viewing direction through the image centre.
  const std::vector<Candidate> sun_candidates = matcher.TakeCandidates();
  const Candidate& best_candidate = *std::ranges::max_element(
      sun_candidates, {}, [](const Candidate& candidate) { return *candidate.fit.neg_log10_nfa; });
  const double relative_azimuth_rad = vertical.AzimuthAt(ObjectCentre(best_candidate.fit, best_candidate.outline));
  const double azimuth_rad =
      RelativeSunAzimuth(model_->views[view].angles->azimuth_rad, std::atan2(mean.y(), mean.x()));
  const Sun relative_sun{.azimuth_rad = WrapAngle(azimuth_rad + relative_azimuth_rad),
                         .elevation_rad = std::atan2(mean.z(), std::hypot(mean.x(), mean.y()))};
  return SunEstimate{relative_sun, neg_log10_nfa[best]};
}

}  // namespace victorious
