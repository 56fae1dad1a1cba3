#include "victorious/recognize/vote_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "victorious/geometry/angles.h"

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
  fields.AddGroup("votes", votes);
}

namespace {

// The views that a scene may show: by their features, and by how far off nadir its lines of sight are.
std::vector<bool> ChooseViews(const ObjectModel& model, const std::optional<Vertical>& vertical, double most_tilt_rad) {
  double least_rad = 0;
  double most_rad = kPi;
  if (vertical) {
    constexpr int kCells = 8;
    std::swap(least_rad, most_rad);
    for (int i = 0; i <= kCells * kCells; ++i) {
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

}  // namespace

VoteSearch::VoteSearch(const ObjectModel& model) {
  views_.reserve(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    views_.push_back(kernels::PackQueries(model.ViewFeatures(view).descriptors));
  }
}

std::vector<Candidate> VoteSearch::Search(const ObjectModel& model, const FeatureSet& scene,
                                          const RankedMatcher& ranked, const std::optional<Vertical>& vertical,
                                          const VoteSearchOptions& options, const PoseOptions& pose_options) const {
  std::vector<Candidate> candidates;
  std::vector<bool> waiting = ChooseViews(model, vertical, options.most_tilt_rad);
  const std::vector<std::size_t> scouts = ChooseScouts(model, waiting);
  const auto compare = [&](std::size_t view) {
    double most_evidence = -std::numeric_limits<double>::infinity();
    if (!waiting[view]) return most_evidence;
    waiting[view] = false;
    std::optional<UprightPrior> upright;
    if (vertical && model.views[view].angles) {
      upright.emplace(*vertical, model.views[view].angles->off_nadir_rad, options.most_tilt_rad);
    }
    const std::vector<RankedMatch> matches = ranked.Match(views_[view], options.nearest);
    std::vector<Pose> poses = VotePoses(scene, model.ViewFeatures(view).keypoints, matches, model.views[view].outline,
                                        options.votes, pose_options, upright);
    for (Pose& pose : poses) {
      most_evidence = std::max(most_evidence, *pose.evidence);
      candidates.push_back({.view = view,
                            .matches = matches.size(),
                            .views = views_.size(),
                            .outline = model.views[view].outline,
                            .pose = std::move(pose)});
    }
    return most_evidence;
  };
  std::vector<std::pair<double, std::size_t>> scouted;  // evidence, view
  for (const std::size_t view : scouts) scouted.emplace_back(compare(view), view);
  std::ranges::stable_sort(scouted, std::greater{}, &std::pair<double, std::size_t>::first);
  scouted.resize(std::min(scouted.size(), static_cast<std::size_t>(options.most_followed)));
  for (const auto& [evidence, scout] : scouted) {
    if (!std::isfinite(evidence)) break;
    for (const std::uint32_t neighbour : model.views[scout].neighbours) compare(neighbour);
  }
  return candidates;
}

}  // namespace victorious
