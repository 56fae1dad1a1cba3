#include "victorious/recognize/vote_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/kernels/nearest.h"

namespace victorious {

void VoteSearchOptions::ListFields(FieldList& fields) {
  fields.Add("nearest", nearest,
             {.min = 1,
              .max = static_cast<double>(kernels::kMostNeighbours),
              .reason = "scene keypoints tried for each template keypoint, the likest first"});
  fields.Add("most_followed", most_followed,
             {.min = 0, .max = 100000, .reason = "views whose neighbours are compared too: those of most evidence"});
  fields.Add("most_tilt_rad", most_tilt_rad,
             {.min = 0.01,
              .max = 3.2,
              .unit = "rad",
              .reason = "where telemetry tells the camera's attitude: an object's up lies so near to the vertical, the "
                        "step between views included; 3.2 lets objects lie as they like"});
  fields.Add("sun_step_rad", sun_step_rad,
             {.min = 0.05,
              .max = 3.2,
              .unit = "rad",
              .reason = "azimuths of the sun so near to each other share what views look like under it: finer is more "
                        "alike, and more to make and to keep in memory"});
  fields.Add("sun_evidence", sun_evidence,
             {.min = -100,
              .max = 1000,
              .unit = "decades",
              .reason = "evidence that an object must have for its light to tell where the sun stands"});
  fields.AddGroup("votes", votes);
}

namespace {

// A view under a soft sky, or under the sun that stands where another view's camera does.
struct Look {
  std::size_t view;
  std::optional<std::size_t> sun_view;
};

// The views that a scene may show: by their features, and by how far off nadir its lines of sight are.
std::vector<bool> ChooseViews(const ObjectModel& model, const std::optional<Vertical>& vertical, double most_tilt_rad) {
  double least_rad = 0;
  double most_rad = kPi;
  if (vertical) {
    constexpr int kCells = 8;
    std::swap(least_rad, most_rad);
    for (int i = 0; i < (kCells + 1) * (kCells + 1); ++i) {
      const Eigen::Vector2d pixel(vertical->pinhole.width * (i % (kCells + 1)) / static_cast<double>(kCells),
                                  vertical->pinhole.height * (i / (kCells + 1)) / static_cast<double>(kCells));
      const double off_nadir_rad = std::acos(std::clamp(-vertical->SeenAt(pixel).z(), -1.0, 1.0));
      least_rad = std::min(least_rad, off_nadir_rad);
      most_rad = std::max(most_rad, off_nadir_rad);
    }
  }
  std::vector<bool> chosen;
  for (const ModelView& view : model.views) {
    const bool fits = !view.angles || (view.angles->off_nadir_rad >= least_rad - most_tilt_rad &&
                                       view.angles->off_nadir_rad <= most_rad + most_tilt_rad);
    chosen.push_back(fits && view.feature_count > 0);
  }
  return chosen;
}

// Of the chosen views some none of which are neighbours, so many that every other is a neighbour of one.
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

// The view whose camera stands nearest to where the sun does.
std::size_t ViewFromSun(const ObjectModel& model, double azimuth_rad, double elevation_rad) {
  const auto closeness = [&](const ModelView& view) {
    const ViewAngles& angles = *view.angles;
    return std::cos(angles.off_nadir_rad) * std::sin(elevation_rad) +
           std::sin(angles.off_nadir_rad) * std::cos(elevation_rad) * std::cos(angles.azimuth_rad - azimuth_rad);
  };
  return static_cast<std::size_t>(std::ranges::max_element(model.views, {}, closeness) - model.views.begin());
}

// From straight above no view tells how the object is turned, and so where its sun stands.
bool TellsHeading(const ModelView& view) {
  constexpr double kLeastOffNadir_rad = 0.3;
  return view.angles && view.angles->off_nadir_rad >= kLeastOffNadir_rad;
}

// Where the sun stands as a view's azimuth, if the object is seen from another view's azimuth; and back.
double SunInModel(double view_azimuth_rad, double sun_ahead_rad) { return view_azimuth_rad + kPi + sun_ahead_rad; }
double SunAhead(double view_azimuth_rad, double sun_in_model_rad) {
  return WrapAngle(sun_in_model_rad - view_azimuth_rad - kPi);
}

// One model against one scene.
class Comparison {
 public:
  Comparison(const ObjectModel& model, const LitTemplates* lit, const VoteScene& scene,
             const std::optional<Vertical>& vertical, std::size_t looks)
      : model_(model), lit_(lit), scene_(scene), vertical_(vertical), looks_(looks) {}

  // The most evidence of a pose that the look finds.
  double Try(const Look& look) {
    const std::shared_ptr<const LitTemplate> made = look.sun_view ? lit_->Under(*look.sun_view, look.view) : nullptr;
    const FeatureView features = made ? made->features.View() : model_.ViewFeatures(look.view);
    const std::span<const Point3> points = made ? std::span(made->points_in_model) : PointsOf(look.view);
    const ModelView& view = model_.views[look.view];
    const std::vector<RankedMatch> matches =
        scene_.ranked.Match(kernels::PackQueries(features.descriptors), scene_.options.nearest);
    std::optional<UprightPrior> upright;
    if (vertical_ && view.angles) {
      upright.emplace(*vertical_, view.angles->off_nadir_rad, scene_.options.most_tilt_rad);
    }
    double most_evidence = -std::numeric_limits<double>::infinity();
    for (Pose& pose : VotePoses(scene_.features, features.keypoints, matches, view.outline, scene_.options.votes,
                                scene_.pose, upright)) {
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

  std::vector<Candidate> TakeCandidates() { return std::move(candidates_); }

 private:
  [[nodiscard]] std::span<const Point3> PointsOf(std::size_t view) const {
    if (model_.points_in_model.empty()) return {};
    return model_.points_in_model.subspan(model_.views[view].first_feature, model_.views[view].feature_count);
  }

  const ObjectModel& model_;
  const LitTemplates* lit_;
  const VoteScene& scene_;
  const std::optional<Vertical>& vertical_;
  std::size_t looks_;
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<Candidate> VoteSearch::Search(const VoteScene& scene, const FrameConditions& conditions) const {
  const VoteSearchOptions& options = scene.options;
  const bool sunny = lit_ && conditions.vertical && conditions.sun_ahead;
  Comparison comparison(*model_, lit_.get(), scene, conditions.vertical, model_->views.size() * (sunny ? 2 : 1));

  struct Lead {
    double evidence;
    std::size_t view;
    bool lit;
  };
  std::vector<bool> waiting[2];  // under a soft sky, under the sun
  const auto compare = [&](std::size_t view, bool lit) {
    if (!waiting[lit][view]) return -std::numeric_limits<double>::infinity();
    waiting[lit][view] = false;
    if (!lit) return comparison.Try({view, {}});
    const double azimuth_rad = SunInModel(model_->views[view].angles->azimuth_rad, conditions.sun_ahead->azimuth_rad);
    const double shared_rad = options.sun_step_rad * std::round(azimuth_rad / options.sun_step_rad);
    return comparison.Try({view, ViewFromSun(*model_, shared_rad, conditions.sun_ahead->elevation_rad)});
  };
  std::vector<Lead> leads;
  for (const bool lit : {false, true}) {
    waiting[lit] = ChooseViews(*model_, conditions.vertical, options.most_tilt_rad);
    if (lit) {
      for (std::size_t view = 0; view < model_->views.size(); ++view) {
        waiting[lit][view] = waiting[lit][view] && sunny && TellsHeading(model_->views[view]);
      }
    }
    for (const std::size_t view : ChooseScouts(*model_, waiting[lit])) leads.push_back({compare(view, lit), view, lit});
  }
  std::ranges::stable_sort(leads, std::greater{}, &Lead::evidence);
  leads.resize(std::min(leads.size(), static_cast<std::size_t>(options.most_followed)));
  for (const Lead& lead : leads) {
    if (!std::isfinite(lead.evidence)) break;
    for (const std::uint32_t neighbour : model_->views[lead.view].neighbours) compare(neighbour, lead.lit);
  }
  return comparison.TakeCandidates();
}

std::optional<Sun> VoteSearch::FindSun(const VoteScene& scene, const Vertical& vertical) const {
  if (!lit_) return std::nullopt;
  constexpr int kAzimuths = 12;
  constexpr double kElevation_rad = kPi / 4;
  const std::vector<std::size_t> scouts =
      ChooseScouts(*model_, ChooseViews(*model_, vertical, scene.options.most_tilt_rad));
  const std::optional<Vertical> known = vertical;
  Comparison comparison(*model_, lit_.get(), scene, known, scouts.size() * kAzimuths);
  double soft = 0;
  double most = scene.options.sun_evidence;
  std::optional<std::pair<std::size_t, double>> best;  // view, the sun's azimuth
  for (const std::size_t view : scouts) {
    soft = std::max(soft, comparison.Try({view, {}}));
    if (!TellsHeading(model_->views[view])) continue;
    for (int i = 0; i < kAzimuths; ++i) {
      const double azimuth_rad = 2 * kPi * i / kAzimuths;
      const double evidence = comparison.Try({view, ViewFromSun(*model_, azimuth_rad, kElevation_rad)});
      if (evidence <= most) continue;
      most = evidence;
      best.emplace(view, azimuth_rad);
    }
  }
  if (!best || most < soft + 1) return std::nullopt;

  // Nearer, by the same view: the mean of the suns about, by how much more each explains.
  const auto& [view, first_rad] = *best;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int around = -3; around <= 3; ++around) {
    for (int up = -3; up <= 2; ++up) {
      const double azimuth_rad = first_rad + RadiansFromDegrees(10.0 * around);
      const double elevation_rad = kElevation_rad + RadiansFromDegrees(10.0 * up);
      const double evidence = comparison.Try({view, ViewFromSun(*model_, azimuth_rad, elevation_rad)});
      const double weight = std::pow(10.0, evidence - most);
      mean += weight * Eigen::Vector3d(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                       std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad));
    }
  }
  return Sun{.azimuth_rad = SunAhead(model_->views[view].angles->azimuth_rad, std::atan2(mean.y(), mean.x())),
             .elevation_rad = std::atan2(mean.z(), std::hypot(mean.x(), mean.y()))};
}

}  // namespace victorious
