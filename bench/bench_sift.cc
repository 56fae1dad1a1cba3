#include <array>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

extern "C" {
#include <vl/sift.h>
}

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/object/features/feature_extractor.h"

namespace victorious::bench {
namespace {

// The same settings for both: those of a search for CAD models. cv::SIFT does not look for impulses, nor do we here.
FeatureOptions SharedOptions() {
  FeatureOptions options = LowContrastFeatureOptions();
  options.engine = "sift";
  options.impulse_fraction = 1;
  return options;
}

// Keypoints and descriptors of the same settings by VLFeat, which has no threads. The first octave is of the doubled
// image.
double CountByVlFeat(const cv::Mat& frame) {
  const FeatureOptions options = SharedOptions();
  cv::Mat values;
  frame.convertTo(values, CV_32F);
  const std::unique_ptr<VlSiftFilt, void (*)(VlSiftFilt*)> filter(
      vl_sift_new(frame.cols, frame.rows, -1, kOctaveLayers, -1), &vl_sift_delete);
  vl_sift_set_peak_thresh(filter.get(), 255 * options.contrast_threshold / kOctaveLayers);
  vl_sift_set_edge_thresh(filter.get(), options.edge_threshold);
  std::size_t count = 0;
  std::array<float, kDescriptorSize> descriptor{};
  for (int state = vl_sift_process_first_octave(filter.get(), values.ptr<float>()); state != VL_ERR_EOF;
       state = vl_sift_process_next_octave(filter.get())) {
    vl_sift_detect(filter.get());
    const VlSiftKeypoint* const keypoints = vl_sift_get_keypoints(filter.get());
    for (int i = 0; i < vl_sift_get_nkeypoints(filter.get()); ++i) {
      std::array<double, 4> angles{};
      const int angle_count = vl_sift_calc_keypoint_orientations(filter.get(), angles.data(), keypoints + i);
      for (int a = 0; a < angle_count; ++a) {
        vl_sift_calc_keypoint_descriptor(filter.get(), descriptor.data(), keypoints + i,
                                         angles[static_cast<std::size_t>(a)]);
        ++count;
      }
    }
  }
  return static_cast<double>(count);
}

Result CompareEngines(const std::string& name, const cv::Mat& frame, int threads, const Settings& settings) {
  const FeatureOptions options = SharedOptions();
  const auto extractor = MakeFeatureExtractor(options).value();
  oneapi::tbb::task_arena arena(threads);
  const auto run = [&] {
    return arena.execute([&] { return static_cast<double>(extractor->Extract(frame).value().size()); });
  };
  const auto run_opencv = [&] {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    cv::SIFT::create(0, kOctaveLayers, options.contrast_threshold, options.edge_threshold, kFirstLayerSigma_px, CV_8U)
        ->detectAndCompute(frame, cv::noArray(), keypoints, descriptors);
    return static_cast<double>(keypoints.size());
  };
  const int threads_before = cv::getNumThreads();
  cv::setNumThreads(threads);
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
  std::vector<Implementation> peers = {{"opencv", run_opencv}};
  if (threads == 1) peers.push_back({"vlfeat", [&] { return CountByVlFeat(frame); }});
  Result result = Compare(name, {"victorious", run}, peers, settings.effort());
  result.figures = {{"keypoints", run()}, {"opencv_keypoints", run_opencv()}, {"threads", threads}};
  if (threads == 1) result.figures.emplace_back("vlfeat_keypoints", CountByVlFeat(frame));
  cv::setNumThreads(threads_before);
  return result;
}

// A frame of the synthetic town sharper than those of the other benchmarks.
cv::Mat SharpFrame(int width, int height) {
  testing::FlightOptions options;
  options.seed = 8;
  options.objects = 4;
  options.width = width;
  options.height = height;
  options.blur_px = 0.8;
  options.noise = 1;
  return GreyFrame(testing::SyntheticFlight(options));
}

}  // namespace

std::vector<Result> BenchSift(const Settings& settings) {
  std::vector<Result> results;
  const cv::Mat vga = SharpFrame(640, 480);
  results.push_back(CompareEngines("sift_vga", vga, 1, settings));
  const bool has_two = oneapi::tbb::info::default_concurrency() >= 2;
  if (!has_two) fmt::print(stderr, "sift: rows of two threads are left out: one processor may be used\n");
  if (has_two) results.push_back(CompareEngines("sift_vga_2_threads", vga, 2, settings));
  if (settings.quick) return results;
  const cv::Mat full_hd = SharpFrame(1920, 1080);
  results.push_back(CompareEngines("sift_1080p", full_hd, 1, settings));
  if (has_two) results.push_back(CompareEngines("sift_1080p_2_threads", full_hd, 2, settings));
  return results;
}

}  // namespace victorious::bench
