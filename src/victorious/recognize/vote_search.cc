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
              .max = static_cast<double>(kernels::kMostNeighbours),
              .reason = "ranked matches per template keypoint: its nearest scene keypoints"});
  fields.Add("most_followed", most_followed,
             {.min = 0,
              .max = 100000,
              .reason = "coarse views whose neighbours are matched, too: those of the highest -log10 NFA"});
  fields.Add("most_pooled", most_pooled,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "views of the highest -log10 NFA that vote once more together with the matches of their "
                        "neighbours: an object seen from between two views matches keypoints of both"});
  fields.Add("most_lit", most_lit,
             {.min = 0,
              .max = 100000,
              .unit = "views",
              .reason = "coarse views that are also matched relit by the sun: those of the highest -log10 NFA under "
                        "diffuse light; by default all, since direct sun may hide features of diffuse light"});
  fields.Add("most_tilt_rad", most_tilt_rad,
             {.min = 0.01,
              .max = 3.2,
              .unit = "rad",
              .reason = "with known camera attitude: maximum angle between an object's up axis and the vertical, the "
                        "angular step between views included; 3.2 allows any attitude of the object"});
  fields.Add(
      "most_hanging_rad", most_hanging_rad,
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
  fields.Add("sun_evidence", sun_evidence,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "minimum -log10 NFA of a pose whose shading determines the sun's direction"});
  fields.Add("most_asked", most_asked,
             {.min = 1,
              .max = 100000,
              .unit = "views",
              .reason = "views per frame that are tested for the sun's direction: those of the highest -log10 NFA "
                        "under diffuse light; each is relit by eight suns"});
  fields.AddGroup("votes", votes);
}

namespace {

constexpr double kNoEvidence = -std::numeric_limits<double>::infinity();

// A template to match: a view under diffuse light, or relit by a sun in the direction of another view's camera.
struct Look {
  std::size_t view;
  std::optional<std::size_t> sun_view;   // nullopt: diffuse light
  std::optional<double> aside_rad = {};  // centre of the azimuth cell that this sun is valid for; nullopt: any
  bool coarse = false;                   // half resolution, as in RelitTemplateKey
};

// For each view: true if the scene may show it: it has features, and its off-nadir angle fits the lines of sight.
std::vector<bool> ChooseViews(const ObjectModel& model, const SightCells& cells, double most_tilt_rad) {
  const auto [least_rad, most_rad] = cells.OffNadir();
  std::vector<bool> chosen;
  for (const ModelView& view : model.views) {
    const bool fits = !view.angles || (view.angles->off_nadir_rad >= least_rad - most_tilt_rad &&
                                       view.angles->off_nadir_rad <= most_rad + most_tilt_rad);
    chosen.push_back(fits && view.feature_count > 0);
  }
  return chosen;
}

// The coarse views: a maximal independent set of the chosen views in the neighbour graph (greedy). Every chosen view is
// a coarse view or the neighbour of one.
std::vector<std::size_t> ChooseScouts(const ObjectModel& model, const std::vector<bool>& chosen) {
  std::vector<std::size_t> scouts;
  std::vector<bool> covered(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    if (covered[view] || !chosen[view]) continue;
    scouts.push_back(view);
    for (const std::uint32_t neighbour : model.views[view].neighbours) covered[neighbour] = true;
  }
  return scouts;
}

// The centre of the object's box in the scene, px.
Eigen::Vector2d MiddleOf(const Pose& pose, const Polygon& outline) {
  const Box box = BoundingBox(ProjectPolygon(pose.scene_from_template_plane, outline));
  return {box.x + box.width / 2, box.y + box.height / 2};
}

// The view whose camera direction is nearest to the sun's direction: quantises the sun.
// @param azimuth_rad  of the sun in the model frame, as ViewAngles::azimuth_rad
std::size_t ViewFromSun(const ObjectModel& model, double azimuth_rad, double elevation_rad) {
  const auto closeness = [&](const ModelView& view) {
    const ViewAngles& angles = *view.angles;
    return std::cos(angles.off_nadir_rad) * std::sin(elevation_rad) +
           std::sin(angles.off_nadir_rad) * std::cos(elevation_rad) * std::cos(angles.azimuth_rad - azimuth_rad);
  };
  return static_cast<std::size_t>(std::ranges::max_element(model.views, {}, closeness) - model.views.begin());
}

// True if the view is oblique enough to determine the object's heading, and with it the sun in the model frame.
bool TellsHeading(const ModelView& view) {
  constexpr double kLeastOffNadir_rad = 0.3;
  return view.angles && view.angles->off_nadir_rad >= kLeastOffNadir_rad;
}

// Converts the sun's azimuth between the viewing direction (relative) and the model frame (as ViewAngles::azimuth_rad),
// for an object seen from view_azimuth_rad.
double SunInModel(double view_azimuth_rad, double sun_ahead_rad) { return view_azimuth_rad + kPi + sun_ahead_rad; }
double SunAhead(double view_azimuth_rad, double sun_in_model_rad) {
  return WrapAngle(sun_in_model_rad - view_azimuth_rad - kPi);
}

// The relit template of a view for an azimuth cell: the sun's azimuth in the model's frame, quantised to sun_step_rad.
// @param sun  relative to the viewing direction through the image centre
Look LitLook(const ObjectModel& model, std::size_t view, double aside_rad, const Sun& sun, double sun_step_rad) {
  const double azimuth_rad = SunInModel(model.views[view].angles->azimuth_rad, sun.azimuth_rad - aside_rad);
  const double shared_rad = sun_step_rad * std::round(azimuth_rad / sun_step_rad);
  return {.view = view, .sun_view = ViewFromSun(model, shared_rad, sun.elevation_rad), .aside_rad = aside_rad};
}

// A matched template and the highest -log10 NFA of its poses.
struct Lead {
  Look look;
  double evidence;
};

std::vector<Lead> ByEvidence(std::vector<Lead> leads) {
  std::ranges::stable_sort(leads, std::greater{}, &Lead::evidence);
  return leads;
}

// Matches templates of one model with one scene and collects the poses.
class Comparison {
 public:
  Comparison(const ObjectModel& model, const LitTemplates* lit, const VoteScene& scene,
             const std::optional<Vertical>& vertical, std::size_t looks)
      : model_(model),
        lit_(lit),
        scene_(scene),
        vertical_(vertical),
        looks_(looks),
        cells_(vertical, scene.features.Searched(), 2 * scene.options.sun_step_rad) {}

  // The azimuth cells of the searched region.
  [[nodiscard]] const SightCells& cells() const { return cells_; }

  // Matches templates; returns the highest -log10 NFA of each, minus infinity without a pose.
  std::vector<double> Try(std::span<const Look> looks) {
    std::vector<LitView> needed;
    for (const Look& look : looks) {
      if (look.sun_view) needed.push_back({*look.sun_view, look.view, look.coarse});
    }
    if (!needed.empty()) lit_->Prepare(needed);
    std::vector<double> evidence;
    for (const Look& look : looks) evidence.push_back(Try(look));
    return evidence;
  }

  std::vector<Lead> Leads(std::span<const Look> looks) {
    const std::vector<double> evidence = Try(looks);
    std::vector<Lead> leads;
    for (std::size_t i = 0; i < looks.size(); ++i) leads.push_back({looks[i], evidence[i]});
    return leads;
  }

  // Pools each of the best templates with the matched neighbours of the same light and votes again.
  void Pool(int most) {
    std::vector<std::size_t> order(compared_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Half resolution is left out: the good ones have been matched at full resolution, too.
    std::erase_if(order, [&](std::size_t i) { return compared_[i].look.coarse; });
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return compared_[i].evidence; });
    for (const std::size_t i : order | std::views::take(most)) {
      const Compared& one = compared_[i];
      if (one.evidence == kNoEvidence) break;
      if (one.evidence >= scene_.options.votes.another_evidence) continue;  // already certain
      std::vector<ComparedTemplate> beside;
      for (const Compared& other : compared_) {
        if (AreBeside(one.look, other.look)) beside.push_back(TemplateOf(other));
      }
      if (beside.empty() || PointsOf(one).empty()) continue;
      const PooledTemplate pooled = victorious::Pool(TemplateOf(one), beside);
      Vote(one.look, pooled.keypoints, pooled.points_in_model, pooled.matches);
    }
  }

  std::vector<Candidate> TakeCandidates() { return std::move(candidates_); }

 private:
  // A matched template and its results.
  struct Compared {
    Look look;
    std::shared_ptr<const LitTemplate> lit;  // null: diffuse light
    std::vector<RankedMatch> matches;
    double evidence = kNoEvidence;
  };

  double Try(const Look& look) {
    Compared compared{.look = look, .lit = {}, .matches = {}};
    if (look.sun_view) compared.lit = lit_->Under({*look.sun_view, look.view, look.coarse});
    const FeatureView features = FeaturesOf(compared);
    compared.matches = scene_.ranked.Match(kernels::PackQueries(features.descriptors), scene_.options.nearest);
    compared.evidence = Vote(look, features.keypoints, PointsOf(compared), compared.matches);
    compared_.push_back(std::move(compared));
    return compared_.back().evidence;
  }

  // Adds the poses of a template's keypoints to the candidates; returns their highest -log10 NFA.
  double Vote(const Look& look, std::span<const Keypoint> keypoints, std::span<const Point3> points,
              std::span<const RankedMatch> matches) {
    const ModelView& view = model_.views[look.view];
    std::optional<UprightPrior> upright;
    if (view.angles) {
      const double off_nadir_rad = view.angles->off_nadir_rad;
      upright = vertical_ ? UprightPrior::Told(*vertical_, off_nadir_rad, scene_.options.most_tilt_rad)
                          : UprightPrior::Supposed(off_nadir_rad, scene_.options.most_hanging_rad);
    }
    double most_evidence = kNoEvidence;
    for (Pose& pose :
         VotePoses(scene_.features, keypoints, matches, view.outline, scene_.options.votes, scene_.pose, upright)) {
      if (!IsUnderItsSun(look, pose)) continue;
      most_evidence = std::max(most_evidence, *pose.evidence);
      if (!points.empty()) {
        for (const Match& match : pose.inliers) pose.inlier_points.push_back(points[match.model]);
      }
      candidates_.push_back({.view = look.view,
                             .matches = matches.size(),
                             .views = looks_,
                             .outline = view.outline,
                             .pose = std::move(pose)});
    }
    return most_evidence;
  }

  // True if the pose lies in the azimuth cell that the template was relit for: each position has one sun.
  [[nodiscard]] bool IsUnderItsSun(const Look& look, const Pose& pose) const {
    if (!look.aside_rad) return true;
    const double aside_rad = vertical_->AzimuthAt(MiddleOf(pose, model_.views[look.view].outline));
    return cells_.MiddleOf(aside_rad) == *look.aside_rad;
  }

  [[nodiscard]] bool AreBeside(const Look& one, const Look& other) const {
    const std::vector<std::uint32_t>& neighbours = model_.views[one.view].neighbours;
    return one.sun_view.has_value() == other.sun_view.has_value() && one.aside_rad == other.aside_rad &&
           one.coarse == other.coarse && std::ranges::find(neighbours, other.view) != neighbours.end();
  }

  [[nodiscard]] FeatureView FeaturesOf(const Compared& compared) const {
    return compared.lit ? compared.lit->features.View() : model_.ViewFeatures(compared.look.view);
  }

  [[nodiscard]] std::span<const Point3> PointsOf(const Compared& compared) const {
    if (compared.lit) return compared.lit->points_in_model;
    if (model_.points_in_model.empty()) return {};
    const ModelView& view = model_.views[compared.look.view];
    return model_.points_in_model.subspan(view.first_feature, view.feature_count);
  }

  [[nodiscard]] ComparedTemplate TemplateOf(const Compared& compared) const {
    return {FeaturesOf(compared).keypoints, PointsOf(compared), compared.matches};
  }

  const ObjectModel& model_;
  const LitTemplates* lit_;
  const VoteScene& scene_;
  const std::optional<Vertical>& vertical_;
  std::size_t looks_;
  SightCells cells_;
  std::vector<Compared> compared_;
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<Candidate> VoteSearch::Search(const VoteScene& scene, const FrameConditions& conditions) const {
  const VoteSearchOptions& options = scene.options;
  const bool sunny = lit_ && conditions.vertical && conditions.sun_ahead;
  Comparison comparison(*model_, lit_.get(), scene, conditions.vertical, model_->views.size() * (sunny ? 2 : 1));

  const std::vector<bool> chosen = ChooseViews(*model_, comparison.cells(), options.most_tilt_rad);
  std::set<std::pair<std::size_t, std::optional<double>>> tried;  // view and azimuth cell; nullopt: diffuse light
  const auto add = [&](std::size_t view, std::optional<double> aside_rad, std::vector<Look>& looks) {
    if (!chosen[view] || (aside_rad && !TellsHeading(model_->views[view]))) return;
    if (!tried.emplace(view, aside_rad).second) return;
    looks.push_back(aside_rad ? LitLook(*model_, view, *aside_rad, *conditions.sun_ahead, options.sun_step_rad)
                              : Look{.view = view, .sun_view = {}});
  };
  std::vector<Look> soft;
  for (const std::size_t view : ChooseScouts(*model_, chosen)) add(view, {}, soft);
  std::vector<Lead> leads = comparison.Leads(soft);
  std::vector<Look> lit;
  std::set<std::size_t> lit_views;
  for (const Lead& lead : ByEvidence(leads)) {  // also those without a pose: direct sun may hide all diffuse features
    const ModelView& view = model_->views[lead.look.view];
    if (!sunny || std::ssize(lit_views) == options.most_lit) break;
    if (!TellsHeading(view)) continue;
    lit_views.insert(lead.look.view);
    for (const double aside_rad : comparison.cells().MiddlesOf(view.angles->off_nadir_rad, options.most_tilt_rad)) {
      add(lead.look.view, aside_rad, lit);
    }
  }
  for (Look& look : lit) look.coarse = true;
  std::ranges::copy(comparison.Leads(lit), std::back_inserter(leads));
  std::vector<Look> near;
  for (const Lead& lead : ByEvidence(leads) | std::views::take(options.most_followed)) {
    if (lead.evidence == kNoEvidence) break;
    if (lead.look.coarse) {  // again at full resolution, as its neighbours
      near.push_back(lead.look);
      near.back().coarse = false;
    }
    for (const std::uint32_t neighbour : model_->views[lead.look.view].neighbours) {
      add(neighbour, lead.look.aside_rad, near);
    }
  }
  comparison.Try(near);
  comparison.Pool(options.most_pooled);
  return comparison.TakeCandidates();
}

std::vector<Candidate> VoteSearch::SearchViews(const VoteScene& scene, const FrameConditions& conditions,
                                               std::span<const std::size_t> views) const {
  const VoteSearchOptions& options = scene.options;
  const bool sunny = lit_ && conditions.vertical && conditions.sun_ahead;
  Comparison comparison(*model_, lit_.get(), scene, conditions.vertical, views.size() * (sunny ? 2 : 1));
  std::vector<Look> looks;
  for (const std::size_t number : views) {
    const ModelView& view = model_->views[number];
    if (view.feature_count == 0) continue;
    looks.push_back({.view = number, .sun_view = {}});
    if (!sunny || !TellsHeading(view)) continue;
    for (const double aside_rad : comparison.cells().MiddlesOf(view.angles->off_nadir_rad, options.most_tilt_rad)) {
      looks.push_back(LitLook(*model_, number, aside_rad, *conditions.sun_ahead, options.sun_step_rad));
    }
  }
  comparison.Try(looks);
  comparison.Pool(options.most_pooled);
  return comparison.TakeCandidates();
}

std::vector<SunLead> VoteSearch::FindSunLeads(const VoteScene& scene, const Vertical& vertical) const {
  if (!lit_) return {};
  const SightCells cells(vertical, scene.features.Searched(), 2 * scene.options.sun_step_rad);
  std::vector<Look> looks;
  for (const std::size_t view : ChooseScouts(*model_, ChooseViews(*model_, cells, scene.options.most_tilt_rad))) {
    if (TellsHeading(model_->views[view])) looks.push_back({.view = view, .sun_view = {}});
  }
  const std::optional<Vertical> known = vertical;
  const std::vector<double> evidence = Comparison(*model_, nullptr, scene, known, looks.size()).Try(looks);
  std::vector<SunLead> leads;
  for (std::size_t i = 0; i < looks.size(); ++i) leads.push_back({looks[i].view, evidence[i]});
  return leads;
}

std::optional<SunFound> VoteSearch::FindSun(const VoteScene& scene, const Vertical& vertical,
                                            std::span<const SunLead> leads) const {
  if (!lit_ || leads.empty()) return std::nullopt;
  constexpr int kAzimuths = 8;
  constexpr double kElevation_rad = kPi / 4;
  std::vector<Look> lit;
  for (const SunLead& lead : leads) {
    for (int i = 0; i < kAzimuths; ++i) {
      lit.push_back({lead.view, ViewFromSun(*model_, 2 * kPi * i / kAzimuths, kElevation_rad)});
    }
  }
  const std::optional<Vertical> known = vertical;
  Comparison comparison(*model_, lit_.get(), scene, known, lit.size());
  const std::vector<double> evidence = comparison.Try(lit);
  const auto best = static_cast<std::size_t>(std::ranges::max_element(evidence) - evidence.begin());
  const double soft = std::ranges::max(leads, {}, &SunLead::evidence).evidence;
  if (evidence[best] < std::max(scene.options.sun_evidence, soft + 1)) return std::nullopt;

  // Refinement with the same view: the mean of the sun directions on a 10 degree grid, weighted by 1 / NFA.
  const std::size_t view = lit[best].view;
  const double first_rad = model_->views[*lit[best].sun_view].angles->azimuth_rad;
  std::vector<Look> nearer;
  std::vector<Eigen::Vector3d> suns;
  for (int around = -3; around <= 3; ++around) {
    for (int up = -3; up <= 2; ++up) {
      const double azimuth_rad = first_rad + RadiansFromDegrees(10.0 * around);
      const double elevation_rad = kElevation_rad + RadiansFromDegrees(10.0 * up);
      nearer.push_back({view, ViewFromSun(*model_, azimuth_rad, elevation_rad)});
      suns.emplace_back(std::cos(elevation_rad) * std::cos(azimuth_rad),
                        std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
    }
  }
  const std::vector<double> nearer_evidence = comparison.Try(nearer);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < suns.size(); ++i) mean += std::pow(10.0, nearer_evidence[i] - evidence[best]) * suns[i];
  // From the object's line of sight to the viewing direction through the image centre.
  const std::vector<Candidate> told = comparison.TakeCandidates();
  const Candidate& surest =
      *std::ranges::max_element(told, {}, [](const Candidate& candidate) { return *candidate.pose.evidence; });
  const double aside_rad = vertical.AzimuthAt(MiddleOf(surest.pose, surest.outline));
  const double azimuth_rad = SunAhead(model_->views[view].angles->azimuth_rad, std::atan2(mean.y(), mean.x()));
  const Sun ahead{.azimuth_rad = WrapAngle(azimuth_rad + aside_rad),
                  .elevation_rad = std::atan2(mean.z(), std::hypot(mean.x(), mean.y()))};
  return SunFound{ahead, evidence[best]};
}

}  // namespace victorious
