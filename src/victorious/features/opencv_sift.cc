#include "victorious/features/opencv_sift.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"
#include "victorious/geometry/angles.h"
#include "victorious/image/impulse_noise.h"

namespace victorious {
namespace {

// OpenCV doubles the image so that the doubled pixel i lies at (i + 0.5) / 2 - 0.5 of the original, but computes the
// keypoint coordinates as i / 2: they are 0.25 px too far right and down. OpenCV's pixel centres are at integers, the
// project's at halves.
constexpr float kShiftPx = 0.5F - 0.25F;

class OpenCvSift final : public FeatureExtractor {
 public:
  explicit OpenCvSift(const FeatureOptions& options) : options_(options) {}

  Expected<FeatureSet> Extract(const cv::Mat& grey) const override {
    VICTORIOUS_CHECK(grey.empty() || grey.type() == CV_8UC1);
    FeatureSet features;
    features.image_width = grey.cols;
    features.image_height = grey.rows;
    const int longest_px = std::max(grey.cols, grey.rows);
    const double shrink = std::min(1.0, static_cast<double>(options_.max_side_px) / std::max(1, longest_px));
    const cv::Size searched(cvRound(grey.cols * shrink), cvRound(grey.rows * shrink));
    if (std::min(searched.width, searched.height) < kMinSidePx) return features;
    try {
      const cv::Mat clean = options_.impulse_fraction < 1 ? RemoveImpulses(grey, options_.impulse_fraction) : grey;
      if (searched == grey.size()) {
        Compute(clean, features);
      } else {
        cv::Mat small;
        cv::resize(clean, small, searched, 0, 0, cv::INTER_AREA);
        Compute(small, features);
        Enlarge(static_cast<double>(grey.cols) / small.cols, static_cast<double>(grey.rows) / small.rows, features);
      }
    } catch (const cv::Exception& error) {
      return Fail(ErrorCode::kInternal,
                  fmt::format("features of a {} x {} image: {}", grey.cols, grey.rows, error.err));
    }
    return features;
  }

 private:
  static constexpr int kMinSidePx = 8;

  void Compute(const cv::Mat& grey, FeatureSet& features) const {
    // A new instance per call: cv::SIFT does not guarantee thread safety, and construction is cheap.
    const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(options_.max_features, kOctaveLayers, options_.contrast_threshold,
                                                    options_.edge_threshold, kFirstLayerSigma_px, CV_8U);
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    sift->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
    features.keypoints.reserve(keypoints.size());
    for (const cv::KeyPoint& keypoint : keypoints) {
      // OpenCV's size is the Gaussian's diameter: twice its sigma.
      features.keypoints.push_back({keypoint.pt.x + kShiftPx, keypoint.pt.y + kShiftPx, keypoint.size / 2,
                                    static_cast<float>(WrapAngle(RadiansFromDegrees(keypoint.angle)))});
    }
    features.descriptors.resize(keypoints.size() * kDescriptorSize);
    for (int row = 0; row < descriptors.rows; ++row) {
      std::memcpy(features.descriptors.data() + static_cast<std::size_t>(row) * kDescriptorSize, descriptors.ptr(row),
                  kDescriptorSize);
    }
  }

  static void Enlarge(double x_factor, double y_factor, FeatureSet& features) {
    for (Keypoint& keypoint : features.keypoints) {
      keypoint.x = static_cast<float>(keypoint.x * x_factor);
      keypoint.y = static_cast<float>(keypoint.y * y_factor);
      keypoint.scale_px = static_cast<float>(keypoint.scale_px * std::sqrt(x_factor * y_factor));
    }
  }

  FeatureOptions options_;
};

}  // namespace

std::unique_ptr<const FeatureExtractor> MakeOpenCvSift(const FeatureOptions& options) {
  return std::make_unique<OpenCvSift>(options);
}

}  // namespace victorious
