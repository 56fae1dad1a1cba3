#include "experiments/match_filters.h"

#include <utility>

#include <opencv2/calib3d.hpp>

namespace victorious {
namespace {

constexpr double kOpenCvThresholdPx = 3;  // OpenCV's default

struct PointPairs {
  std::vector<cv::Point2f> in_template;
  std::vector<cv::Point2f> in_scene;
};

PointPairs CollectPoints(const MatchTrial& trial, const MatchSet& matches) {
  PointPairs points;
  for (const Match& match : matches) {
    const Keypoint& model = trial.Template().keypoints[match.template_keypoint];
    const Keypoint& scene = trial.features->keypoints[match.scene_keypoint];
    points.in_template.emplace_back(model.x, model.y);
    points.in_scene.emplace_back(scene.x, scene.y);
  }
  return points;
}

MatchSet SelectInliers(const MatchSet& matches, const cv::Mat& inliers) {
  MatchSet kept;
  for (std::size_t i = 0; i < matches.size() && i < inliers.total(); ++i) {
    if (inliers.at<unsigned char>(static_cast<int>(i)) != 0) kept.push_back(matches[i]);
  }
  return kept;
}

MatchSet OpenCvSimilarity(const MatchTrial& trial, const MatchSet& matches) {
  if (matches.size() < 2) return {};
  const PointPairs points = CollectPoints(trial, matches);
  cv::Mat inliers;
  cv::estimateAffinePartial2D(points.in_template, points.in_scene, inliers, cv::RANSAC, kOpenCvThresholdPx);
  return SelectInliers(matches, inliers);
}

MatchSet OpenCvHomography(const MatchTrial& trial, const MatchSet& matches) {
  constexpr std::size_t kMinMatches = 4;
  if (matches.size() < kMinMatches) return {};
  const PointPairs points = CollectPoints(trial, matches);
  cv::Mat inliers;
  cv::findHomography(points.in_template, points.in_scene, cv::RANSAC, kOpenCvThresholdPx, inliers);
  return SelectInliers(matches, inliers);
}

}  // namespace

MatchFilter MakeGrammarFilter(std::string name, const CascadeOptions& options, MatchFilterKind kind) {
  return {kind, std::move(name), [options](const MatchTrial& trial, const MatchSet& matches) {
            return FilterByGrammar(trial.features->keypoints, trial.Template().keypoints, matches, options).third;
          }};
}

std::vector<MatchFilter> MakeMatchFilters(const RecognizeOptions& options) {
  const auto grammar = [&](MatchFilterKind kind, std::string name, CascadeFilter filter) {
    CascadeOptions chosen = options.cascade;
    chosen.filter = filter;
    return MakeGrammarFilter(std::move(name), chosen, kind);
  };
  const PoseOptions pose = options.pose;
  const MatchFilter cascade = grammar(MatchFilterKind::kCascade, "cascade", CascadeFilter::kCascade);
  return {grammar(MatchFilterKind::kNone, "none", CascadeFilter::kNone),
          grammar(MatchFilterKind::kNeighbours, "neighbours (Video Google)", CascadeFilter::kNeighbours),
          grammar(MatchFilterKind::kSingleStage, "first stage alone", CascadeFilter::kFirst),
          grammar(MatchFilterKind::kSingleStage, "second stage alone", CascadeFilter::kSecond),
          grammar(MatchFilterKind::kSingleStage, "third stage alone", CascadeFilter::kThird),
          cascade,
          {MatchFilterKind::kCascadeThenMlesac, "cascade, then MLESAC",
           [=](const MatchTrial& trial, const MatchSet& matches) {
             return trial.Mlesac(cascade.run(trial, matches), pose);
           }},
          {MatchFilterKind::kMlesac, "MLESAC alone",
           [=](const MatchTrial& trial, const MatchSet& matches) { return trial.Mlesac(matches, pose); }},
          {MatchFilterKind::kOpenCvSimilarity, "OpenCV's similarity alone", OpenCvSimilarity},
          {MatchFilterKind::kOpenCvHomography, "OpenCV's homography alone", OpenCvHomography}};
}

}  // namespace victorious
