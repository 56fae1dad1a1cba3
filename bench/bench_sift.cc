#include <opencv2/features2d.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/features/feature_extractor.h"

namespace victorious::bench {

std::vector<Result> BenchSift(const Settings& settings) {
  const cv::Mat frame = GreyFrame(MakeSyntheticFlight());
  const auto extractor = MakeFeatureExtractor({}).value();
  const Implementation ours = {"victorious",
                               [&] { return static_cast<double>(extractor->Extract(frame).value().size()); }};
  const Implementation opencv = {"opencv", [&] {
                                   std::vector<cv::KeyPoint> keypoints;
                                   cv::Mat descriptors;
                                   cv::SIFT::create()->detectAndCompute(frame, cv::noArray(), keypoints, descriptors);
                                   return static_cast<double>(keypoints.size());
                                 }};
  Result result = Compare("sift", ours, {opencv}, settings.effort());
  result.figures = {{"keypoints", ours.run()}};
  return {result};
}

}  // namespace victorious::bench
