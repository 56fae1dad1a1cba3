#include "victorious/object/features/opencv_sift.h"

#include <cstring>

#include <fmt/format.h>
#include <opencv2/features2d.hpp>

#include "victorious/geometry/angles.h"
#include "victorious/object/features/searched_image.h"

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
    FeatureSet features;
    features.image_width = grey.cols;
    features.image_height = grey.rows;
    VICTORIOUS_ASSIGN_OR_RETURN(const cv::Mat searched, MakeSearchedImage(grey, options_));
    if (searched.empty()) return features;
    try {
      Compute(searched, features);
    } catch (const cv::Exception& error) {
      return Fail(ErrorCode::kInternal,
                  fmt::format("features of a {} x {} image: {}", grey.cols, grey.rows, error.err));
    }
    ScaleKeypoints(searched.size(), grey.size(), features);
    return features;
  }

 private:
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

  FeatureOptions options_;
};

}  // namespace

std::unique_ptr<const FeatureExtractor> MakeOpenCvSift(const FeatureOptions& options) {
  return std::make_unique<OpenCvSift>(options);
}

}  // namespace victorious
