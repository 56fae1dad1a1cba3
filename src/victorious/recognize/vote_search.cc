#include "victorious/recognize/vote_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace victorious {

void VoteSearchOptions::ListFields(FieldList& fields) {
  fields.Add("nearest", nearest,
             {.min = 1,
              .max = static_cast<double>(kernels::kMostNeighbours),
              .reason = "scene keypoints tried for each template keypoint, the likest first"});
  fields.Add("most_followed", most_followed,
             {.min = 0, .max = 100000, .reason = "views whose neighbours are compared too: those of most evidence"});
  fields.AddGroup("votes", votes);
}

namespace {

// Views none of which are neighbours, so many that every other view is a neighbour of one. Views without features find
// nothing, so scout for none.
std::vector<std::size_t> ChooseScouts(const ObjectModel& model) {
  std::vector<std::size_t> scouts;
  std::vector<bool> covered(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    if (covered[view] || model.views[view].feature_count == 0) continue;
    scouts.push_back(view);
    for (const std::uint32_t neighbour : model.views[view].neighbours) covered[neighbour] = true;
  }
  return scouts;
}

}  // namespace

VoteSearch::VoteSearch(const ObjectModel& model) : scouts_(ChooseScouts(model)) {
  views_.reserve(model.views.size());
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    views_.push_back(kernels::PackQueries(model.ViewFeatures(view).descriptors));
  }
}

std::vector<Candidate> VoteSearch::Search(const ObjectModel& model, const FeatureSet& scene,
                                          const RankedMatcher& ranked, const VoteSearchOptions& options,
                                          const PoseOptions& pose_options) const {
  std::vector<Candidate> candidates;
  std::vector<bool> compared(views_.size());
  const auto compare = [&](std::size_t view) {
    double most_evidence = -std::numeric_limits<double>::infinity();
    if (compared[view]) return most_evidence;
    compared[view] = true;
    const std::vector<RankedMatch> matches = ranked.Match(views_[view], options.nearest);
    std::vector<Pose> poses = VotePoses(scene, model.ViewFeatures(view).keypoints, matches, model.views[view].outline,
                                        options.votes, pose_options);
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
  for (const std::size_t view : scouts_) scouted.emplace_back(compare(view), view);
  std::ranges::stable_sort(scouted, std::greater{}, &std::pair<double, std::size_t>::first);
  scouted.resize(std::min(scouted.size(), static_cast<std::size_t>(options.most_followed)));
  for (const auto& [evidence, scout] : scouted) {
    if (!std::isfinite(evidence)) break;
    for (const std::uint32_t neighbour : model.views[scout].neighbours) compare(neighbour);
  }
  return candidates;
}

}  // namespace victorious
