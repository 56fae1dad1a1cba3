// The reference cascade: the thesis's algorithms 1 to 3, then section 3.3.4. The tests compare cascade.cc with it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "victorious/geometry/pair_measures.h"
#include "victorious/search/grammar/cascade.h"
#include "victorious/search/grammar/template_radius.h"

namespace victorious {
namespace {

using Agree = std::function<bool(const PairMeasures& scene, const PairMeasures& model)>;

// R of each match, px.
std::vector<double> ComputeRadii(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                 const MatchSet& matches, const CascadeOptions& options) {
  const double template_radius = TemplateRadius(model);
  std::vector<double> radii;
  for (const Match& match : matches) {
    const double scale_change =
        static_cast<double>(scene[match.scene_keypoint].scale_px) / model[match.template_keypoint].scale_px;
    radii.push_back(options.radius == CascadeRadius::kScale ? scale_change * (options.radius_fraction * template_radius)
                                                            : options.radius_px);
  }
  return radii;
}

MatchSet Stage(std::span<const Keypoint> scene, std::span<const Keypoint> model, const MatchSet& matches,
               const CascadeOptions& options, double approval, bool distinct, const Agree& agree) {
  const std::vector<double> radii = ComputeRadii(scene, model, matches, options);
  // A voter is identified by its match index or, if votes must be distinct, by its template keypoint.
  std::vector<std::set<std::uint32_t>> votes(matches.size());
  std::vector<std::set<std::uint32_t>> possible_votes(matches.size());
  for (std::uint32_t i = 0; i < matches.size(); ++i) {
    for (std::uint32_t j = i + 1; j < matches.size(); ++j) {
      const Keypoint& scene_i = scene[matches[i].scene_keypoint];
      const Keypoint& scene_j = scene[matches[j].scene_keypoint];
      const double distance =
          std::hypot(static_cast<double>(scene_i.x) - scene_j.x, static_cast<double>(scene_i.y) - scene_j.y);
      if (distance == 0) continue;
      const bool j_may_vote = distance < radii[i];
      const bool i_may_vote = distance < radii[j];
      const std::uint32_t voter_i = distinct ? matches[i].template_keypoint : i;
      const std::uint32_t voter_j = distinct ? matches[j].template_keypoint : j;
      if (j_may_vote) possible_votes[i].insert(voter_j);
      if (i_may_vote) possible_votes[j].insert(voter_i);
      const Keypoint& model_i = model[matches[i].template_keypoint];
      const Keypoint& model_j = model[matches[j].template_keypoint];
      if (model_i.x == model_j.x && model_i.y == model_j.y) continue;
      if (agree(MeasurePair(scene_i, scene_j), MeasurePair(model_i, model_j))) {
        if (j_may_vote) votes[i].insert(voter_j);
        if (i_may_vote) votes[j].insert(voter_i);
      }
    }
  }
  MatchSet kept;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto count = static_cast<double>(votes[i].size());
    if (count >= options.min_votes && count > approval * static_cast<double>(possible_votes[i].size()))
      kept.push_back(matches[i]);
  }
  return kept;
}

}  // namespace

CascadeResult FilterByGrammarRef(std::span<const Keypoint> scene, std::span<const Keypoint> model,
                                 const MatchSet& matches, const CascadeOptions& options) {
  const Agree scales_agree = [&](const PairMeasures& s, const PairMeasures& m) {
    return RatioDistortion(s.scale_ratio, m.scale_ratio) < options.scale_distortion &&
           RatioDistortion(s.mean_scale_to_distance, m.mean_scale_to_distance) < options.distance_distortion;
  };
  const Agree angles_agree = [&](const PairMeasures& s, const PairMeasures& m) {
    return OrientationDistortion(s, m) < options.orientation_distortion_rad &&
           MeanOrientationDistortion(s, m) < options.line_distortion_rad;
  };
  const Agree all_agree = [&](const PairMeasures& s, const PairMeasures& m) {
    return scales_agree(s, m) && angles_agree(s, m);
  };
  const auto runs = [&](CascadeFilter stage) {
    return options.filter == CascadeFilter::kCascade || options.filter == stage;
  };
  const auto stage = [&](CascadeFilter filter, const MatchSet& in, double approval, bool distinct, const Agree& agree) {
    return runs(filter) ? Stage(scene, model, in, options, approval, distinct, options.all_measures ? all_agree : agree)
                        : in;
  };
  CascadeResult result;
  result.first =
      stage(CascadeFilter::kFirst, matches, options.first_approval, options.distinct_stages >= 3, scales_agree);
  result.second =
      stage(CascadeFilter::kSecond, result.first, options.second_approval, options.distinct_stages >= 2, angles_agree);
  result.third =
      stage(CascadeFilter::kThird, result.second, options.third_approval, options.distinct_stages >= 1, scales_agree);
  return result;
}

}  // namespace victorious
