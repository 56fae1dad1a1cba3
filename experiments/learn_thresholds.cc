#include "experiments/learn_thresholds.h"

#include <array>
#include <cmath>
#include <limits>

#include "victorious/geometry/pair_measures.h"
#include "victorious/lab/evaluate/score.h"

namespace victorious {
namespace {

constexpr std::array kLearntRatios = {0.8, 0.95};

// The distortions of each pair of true matches, one list per measure.
struct Distortions {
  std::vector<double> scale;
  std::vector<double> distance;
  std::vector<double> orientation;
  std::vector<double> line;

  void Add(const MatchTrial& trial, const MatchSet& matches, double radius_px) {
    const std::span<const Keypoint> in_scene = trial.features->keypoints;
    const std::span<const Keypoint> in_model = trial.Template().keypoints;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      for (std::size_t j = i + 1; j < matches.size(); ++j) {
        const Keypoint& scene_i = in_scene[matches[i].scene_keypoint];
        const Keypoint& scene_j = in_scene[matches[j].scene_keypoint];
        const Keypoint& model_i = in_model[matches[i].template_keypoint];
        const Keypoint& model_j = in_model[matches[j].template_keypoint];
        const double apart_px = std::hypot(scene_i.x - scene_j.x, scene_i.y - scene_j.y);
        const bool one_place = apart_px == 0 || (model_i.x == model_j.x && model_i.y == model_j.y);
        if (one_place || !(apart_px < radius_px)) continue;
        const PairMeasures s = MeasurePair(scene_i, scene_j);
        const PairMeasures m = MeasurePair(model_i, model_j);
        scale.push_back(RatioDistortion(s.scale_ratio, m.scale_ratio));
        distance.push_back(RatioDistortion(s.mean_scale_to_distance, m.mean_scale_to_distance));
        orientation.push_back(OrientationDistortion(s, m));
        line.push_back(MeanOrientationDistortion(s, m));
      }
    }
  }
};

struct ReadyTrial {
  const MatchTrial* trial;
  MatchSet matches;
  MatchCount before;
};

double Loss(const std::vector<ReadyTrial>& ready, const CascadeOptions& options) {
  constexpr double kCostOfFalse = 2;
  double loss = 0;
  for (const ReadyTrial& one : ready) {
    const MatchSet left =
        FilterByGrammar(one.trial->features->keypoints, one.trial->Template().keypoints, one.matches, options).third;
    const MatchCount after = one.trial->Count(left);
    loss += one.before.correct - after.correct + kCostOfFalse * after.FalseMatches();
  }
  return loss;
}

}  // namespace

CascadeOptions LearnThresholds(const std::vector<const MatchTrial*>& trials, const CascadeOptions& start) {
  constexpr double kPercent = 98;
  Distortions distortions;
  std::vector<ReadyTrial> ready;
  for (const MatchTrial* trial : trials) {
    for (const double ratio : kLearntRatios) {
      MatchSet matches = trial->Matches(ratio);
      const MatchCount before = trial->Count(matches);
      ready.push_back({trial, matches, before});
      if (ratio != kLearntRatios.back()) continue;
      std::erase_if(matches, [&](const Match& match) {
        return trial->truth.Label(trial->features->keypoints[match.scene_keypoint], match.template_keypoint) !=
               MatchLabel::kTrue;
      });
      distortions.Add(*trial, matches, start.radius_px);
    }
  }
  CascadeOptions learnt = start;
  learnt.scale_distortion = Percentile(distortions.scale, kPercent).value_or(start.scale_distortion);
  learnt.distance_distortion = Percentile(distortions.distance, kPercent).value_or(start.distance_distortion);
  learnt.orientation_distortion_rad =
      Percentile(distortions.orientation, kPercent).value_or(start.orientation_distortion_rad);
  learnt.line_distortion_rad = Percentile(distortions.line, kPercent).value_or(start.line_distortion_rad);
  CascadeOptions best = learnt;
  double least = std::numeric_limits<double>::infinity();
  for (const int votes : {2, 3}) {
    for (const double first : {0.1, 0.15, 0.2}) {
      for (const double second : {0.2, 0.3, 0.4}) {
        for (const double third : {0.5, 0.6, 0.7}) {
          CascadeOptions options = learnt;
          options.min_votes = votes;
          options.first_approval = first;
          options.second_approval = second;
          options.third_approval = third;
          const double loss = Loss(ready, options);
          if (!(loss < least)) continue;
          least = loss;
          best = options;
        }
      }
    }
  }
  return best;
}

}  // namespace victorious
