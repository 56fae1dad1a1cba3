// How the search of one frame grows: with the number of models, with the size of the frame, and beside what a plain
// OpenCV program does for the same job.
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/search/recognize/recognizer.h"

namespace victorious::bench {
namespace {

// Models of the plain program: it compares every view with the frame, some 0.3 s a model.
constexpr std::size_t kMaxPeerModels = 25;

// The descriptors of one view as cv::BFMatcher reads them, and the positions of its keypoints.
struct PlainView {
  cv::Mat descriptors;  // CV_32F, one row a keypoint
  std::vector<cv::Point2f> points;
};

std::vector<PlainView> MakePlainViews(const std::vector<ObjectModel>& models) {
  std::vector<PlainView> views;
  for (const FeatureView& view : CollectViews(models)) {
    PlainView plain{.descriptors = FloatDescriptors(view), .points = {}};
    for (const Keypoint& keypoint : view.keypoints) plain.points.emplace_back(keypoint.x, keypoint.y);
    views.push_back(std::move(plain));
  }
  return views;
}

// SIFT, two nearest neighbours by brute force, Lowe's ratio, and a similarity by RANSAC for each view.
// @return the number of views with 8 inliers
double FindByPlainOpenCv(const cv::Mat& grey, const std::vector<PlainView>& views) {
  constexpr float kRatio = 0.8F;
  constexpr int kMinInliers = 8;
  constexpr double kInlier_px = 3;
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const FeatureOptions options;
  cv::SIFT::create(0, 3, options.contrast_threshold, options.edge_threshold)
      ->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  const cv::BFMatcher matcher(cv::NORM_L2);
  int found = 0;
  for (const PlainView& view : views) {
    std::vector<std::vector<cv::DMatch>> nearest;
    matcher.knnMatch(view.descriptors, descriptors, nearest, 2);
    std::vector<cv::Point2f> from;
    std::vector<cv::Point2f> to;
    for (const std::vector<cv::DMatch>& pair : nearest) {
      if (pair.size() < 2 || pair[0].distance >= kRatio * pair[1].distance) continue;
      from.push_back(view.points[static_cast<std::size_t>(pair[0].queryIdx)]);
      to.push_back(keypoints[static_cast<std::size_t>(pair[0].trainIdx)].pt);
    }
    if (from.size() < kMinInliers) continue;
    cv::Mat inliers;
    cv::estimateAffinePartial2D(from, to, inliers, cv::RANSAC, kInlier_px);
    found += cv::countNonZero(inliers) >= kMinInliers ? 1 : 0;
  }
  return found;
}

Result TimeSearch(std::string name, const std::vector<ObjectModel>& models, SearchMethod method, const cv::Mat& frame,
                  const Settings& settings) {
  const auto extractor = MakeFeatureExtractor({}).value();
  RecognizeOptions options;
  options.method = method;
  const Recognizer recognizer = Recognizer::Create(models, FeatureOptions().engine, options).value();
  const Implementation ours = {"victorious", [&] {
                                 const FeatureSet features = extractor->Extract(frame).value();
                                 return static_cast<double>(recognizer.Recognize(features).value().size());
                               }};
  std::vector<PlainView> views;
  std::vector<Implementation> peers;
  if (models.size() <= kMaxPeerModels && method != SearchMethod::kVotes) {
    views = MakePlainViews(models);
    peers.push_back({"opencv", [&] { return FindByPlainOpenCv(frame, views); }});
  }
  Effort effort = settings.effort();
  if (!settings.quick) effort.min_rounds = 3;
  Result result = Compare(std::move(name), ours, peers, effort);
  result.figures = {{"models", static_cast<double>(models.size())},
                    {"ms_per_model", result.median_ms / static_cast<double>(models.size())},
                    {"keypoints", static_cast<double>(ExtractFeatures(frame).size())},
                    {"found", ours.run()}};
  return result;
}

}  // namespace

std::vector<Result> BenchGrowth(const Settings& settings) {
  const std::vector<std::size_t> counts =
      settings.quick ? std::vector<std::size_t>{1, 2} : std::vector<std::size_t>{1, 5, 25, 100, 400};
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const cv::Mat frame = GreyFrame(flight);
  const int every = settings.quick ? 50 : 1;
  const std::vector<ObjectModel> all = MakeAllRoundModels(flight, every, counts.back());

  std::vector<Result> results;
  for (const std::size_t count : counts) {
    const std::vector<ObjectModel> models(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
    const std::string size = fmt::format("{}x{}", count, models.front().views.size());
    results.push_back(TimeSearch("growth_" + size, models, SearchMethod::kShortlist, frame, settings));
    if (count <= kMaxPeerModels) {
      results.push_back(TimeSearch("growth_votes_" + size, models, SearchMethod::kVotes, frame, settings));
    }
  }
  const std::vector<ObjectModel> few(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(counts[1]));
  for (const double factor : {0.5, 2.0, 3.0}) {
    cv::Mat resized;
    cv::resize(frame, resized, {}, factor, factor, factor < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
    results.push_back(TimeSearch(fmt::format("growth_{}x{}_px", resized.cols, resized.rows), few,
                                 SearchMethod::kShortlist, resized, settings));
    if (settings.quick) break;
  }
  return results;
}

}  // namespace victorious::bench
