#include "victorious/object/features/searched_image.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/input/image/impulse_noise.h"

namespace victorious {
namespace {

constexpr int kMinSidePx = 8;

}  // namespace

Expected<cv::Mat> MakeSearchedImage(const cv::Mat& grey, const FeatureOptions& options) {
  VICTORIOUS_CHECK(grey.empty() || grey.type() == CV_8UC1);
  const int longest_px = std::max(grey.cols, grey.rows);
  const double shrink = std::min(1.0, static_cast<double>(options.max_side_px) / std::max(1, longest_px));
  const cv::Size size(cvRound(grey.cols * shrink), cvRound(grey.rows * shrink));
  if (std::min(size.width, size.height) < kMinSidePx) return cv::Mat();
  try {
    cv::Mat clean = RemoveImpulses(grey, options.impulse_fraction);
    if (size == grey.size()) return clean;
    cv::Mat small;
    cv::resize(clean, small, size, 0, 0, cv::INTER_AREA);
    return small;
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kInternal, fmt::format("features of a {} x {} image: {}", grey.cols, grey.rows, error.err));
  }
}

void ScaleKeypoints(const cv::Size& searched, const cv::Size& given, FeatureSet& features) {
  if (searched == given) return;
  const double x_factor = static_cast<double>(given.width) / searched.width;
  const double y_factor = static_cast<double>(given.height) / searched.height;
  for (Keypoint& keypoint : features.keypoints) {
    keypoint.x = static_cast<float>(keypoint.x * x_factor);
    keypoint.y = static_cast<float>(keypoint.y * y_factor);
    keypoint.scale_px = static_cast<float>(keypoint.scale_px * std::sqrt(x_factor * y_factor));
  }
}

}  // namespace victorious
