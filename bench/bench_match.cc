#include <cstddef>
#include <span>

#include <opencv2/features2d.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/kernels/nearest.h"
#include "victorious/search/match/matcher.h"

namespace victorious::bench {
namespace {

std::size_t CountByOpenCv(const cv::Mat& scene, const std::vector<cv::Mat>& templates, double ratio) {
  const cv::BFMatcher matcher(cv::NORM_L2);
  std::size_t count = 0;
  for (const cv::Mat& descriptors : templates) {
    std::vector<std::vector<cv::DMatch>> nearest;  // knnMatch appends
    matcher.knnMatch(scene, descriptors, nearest, 2);
    for (const auto& two : nearest) {
      if (two.size() == 2 && two[0].distance < ratio * two[1].distance) ++count;
    }
  }
  return count;
}

std::size_t CountOurs(const FeatureSet& scene, const TemplateSet& templates) {
  std::size_t count = 0;
  for (const MatchSet& matches : MatchFeatures(scene.View(), templates, {})) count += matches.size();
  return count;
}

Result CompareWithOpenCv(const FeatureSet& scene, const std::vector<FeatureView>& views, const Settings& settings) {
  const TemplateSet templates(views);
  const cv::Mat float_scene = FloatDescriptors(scene.View());
  std::vector<cv::Mat> float_templates;
  std::size_t descriptors = 0;
  for (const FeatureView& view : views) {
    float_templates.push_back(FloatDescriptors(view));
    descriptors += view.size();
  }
  const Implementation ours = {"victorious", [&] { return static_cast<double>(CountOurs(scene, templates)); }};
  const Implementation opencv = {
      "opencv", [&] { return static_cast<double>(CountByOpenCv(float_scene, float_templates, MatchOptions().ratio)); }};
  Result result = Compare("match", ours, {opencv}, settings.effort());
  result.figures = {{"keypoints", static_cast<double>(scene.size())},
                    {"views", static_cast<double>(views.size())},
                    {"descriptors", static_cast<double>(descriptors)},
                    {"matches", ours.run()},
                    {"opencv_matches", opencv.run()}};
  return result;
}

Result CompareKernels(const FeatureSet& scene, std::span<const FeatureView> views, const Settings& settings) {
  using Kernel =
      void (*)(const kernels::PackedQueries&, const kernels::PackedDescriptors&, std::span<kernels::NearestTwo>);
  const TemplateSet templates(views);
  const kernels::PackedQueries queries = kernels::PackQueries(scene.descriptors);
  std::vector<kernels::NearestTwo> nearest(queries.count);
  const auto by = [&](const char* name, Kernel kernel) {
    return Implementation{name, [&, kernel] {
                            double sum = 0;
                            for (std::size_t t = 0; t < templates.size(); ++t) {
                              kernel(queries, templates[t], nearest);
                              sum += nearest.front().best_distance2;
                            }
                            return sum;
                          }};
  };
  Result result = Compare("match_kernels", by("best", &kernels::FindNearestTwo),
                          {by("highway", &kernels::FindNearestTwoSimd), by("reference", &kernels::FindNearestTwoRef)},
                          settings.effort());
  result.figures = {{"keypoints", static_cast<double>(scene.size())}, {"views", static_cast<double>(views.size())}};
  return result;
}

}  // namespace

std::vector<Result> BenchMatch(const Settings& settings) {
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const FeatureSet scene = ExtractFeatures(GreyFrame(flight));
  const std::vector<ObjectModel> models = MakeAllRoundModels(flight, settings.quick ? 50 : 1);
  const std::vector<FeatureView> views = CollectViews(models);
  const std::size_t part = std::min<std::size_t>(views.size(), settings.quick ? 2 : 25);
  return {CompareWithOpenCv(scene, views, settings), CompareKernels(scene, std::span(views).first(part), settings)};
}

}  // namespace victorious::bench
