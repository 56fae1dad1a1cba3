#include "victorious/category/common/dense_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

constexpr int kCells = 4;                   // per side
constexpr int kOrientations = 8;            // per cell
constexpr float kClip = 0.2F;               // Lowe's limit of one orientation of a cell in the normalised descriptor
constexpr float kUnit = 512.0F;             // L2 norm of a descriptor, as in features/
constexpr double kMinSmoothing_px = 0.5;    // sigma of the smoothing before the gradient
constexpr double kSmoothingsPerCell = 6;    // side of a cell in sigmas of that smoothing
constexpr double kAveragingsPerCell = 2.4;  // side of a cell in sigmas of the average over it

using Planes = std::array<cv::Mat, kOrientations>;

// Gradient magnitude per orientation, interpolated linearly between the two nearest of 8 orientations and averaged over
// a cell around each pixel.
Planes OrientationPlanes(const cv::Mat& grey, double cell_px) {
  cv::Mat image;
  grey.convertTo(image, CV_32F);
  cv::GaussianBlur(image, image, {}, std::max(kMinSmoothing_px, cell_px / kSmoothingsPerCell));
  cv::Mat dx;
  cv::Mat dy;
  cv::Scharr(image, dx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(image, dy, CV_32F, 0, 1, 1.0 / 32);
  Planes planes;
  for (cv::Mat& plane : planes) plane = cv::Mat::zeros(grey.size(), CV_32F);
  constexpr float kPerRadian = kOrientations / (2 * std::numbers::pi_v<float>);
  for (int y = 0; y < grey.rows; ++y) {
    const float* gx = dx.ptr<float>(y);
    const float* gy = dy.ptr<float>(y);
    for (int x = 0; x < grey.cols; ++x) {
      const float magnitude = std::sqrt(gx[x] * gx[x] + gy[x] * gy[x]);
      if (magnitude == 0) continue;
      const float bin = std::atan2(gy[x], gx[x]) * kPerRadian + kOrientations;
      const int low = static_cast<int>(bin);
      const float share = bin - static_cast<float>(low);
      planes[static_cast<std::size_t>(low % kOrientations)].at<float>(y, x) += (1 - share) * magnitude;
      planes[static_cast<std::size_t>((low + 1) % kOrientations)].at<float>(y, x) += share * magnitude;
    }
  }
  const int window = 2 * static_cast<int>(std::lround(cell_px / 2)) + 1;
  for (cv::Mat& plane : planes) cv::GaussianBlur(plane, plane, {window, window}, cell_px / kAveragingsPerCell);
  return planes;
}

struct Raw {
  std::array<float, kDescriptorSize> values;
  float norm = 0;
};

Raw Sample(const Planes& planes, double x, double y, double cell_px) {
  Raw raw;
  float squared = 0;
  std::size_t at = 0;
  for (int row = 0; row < kCells; ++row) {
    const int py = static_cast<int>(y + (row - 1.5) * cell_px);
    for (int column = 0; column < kCells; ++column) {
      const int px = static_cast<int>(x + (column - 1.5) * cell_px);
      for (const cv::Mat& plane : planes) {
        const float value = plane.ptr<float>(py)[px];
        raw.values[at++] = value;
        squared += value * value;
      }
    }
  }
  raw.norm = std::sqrt(squared);
  return raw;
}

void AppendDescriptor(Raw& raw, std::vector<std::uint8_t>& out) {
  float squared = 0;
  for (float& value : raw.values) {
    value = std::min(value / raw.norm, kClip);
    squared += value * value;
  }
  const float factor = kUnit / std::sqrt(squared);
  for (const float value : raw.values)
    out.push_back(static_cast<std::uint8_t>(std::min(255.0F, std::round(value * factor))));
}

}  // namespace

void DenseOptions::ListFields(FieldList& fields) {
  fields.Add("step_px", step_px, {.min = 2, .max = 64, .unit = "px", .reason = "spacing of the grid points"});
  fields.Add("sizes", sizes, {.min = 1, .max = 8, .reason = "number of patch scales"});
  fields.Add("max_side_px", max_side_px,
             {.min = 64,
              .max = 4096,
              .unit = "px",
              .reason = "images with a longer side are downscaled to it: categories are trained on images of about "
                        "300 px, and the limit bounds time and memory"});
}

FeatureSet DenseFeatures(const cv::Mat& grey, const DenseOptions& options) {
  VICTORIOUS_CHECK(grey.empty() || grey.type() == CV_8UC1);
  FeatureSet features;
  features.image_width = grey.cols;
  features.image_height = grey.rows;
  const int longest_px = std::max(grey.cols, grey.rows);
  const double shrink = std::min(1.0, static_cast<double>(options.max_side_px) / std::max(1, longest_px));
  const cv::Size size(cvRound(grey.cols * shrink), cvRound(grey.rows * shrink));
  if (size.width < 1 || size.height < 1) return features;
  cv::Mat image = grey;
  if (size != grey.size()) cv::resize(grey, image, size, 0, 0, cv::INTER_AREA);

  double cell_px = kDenseMinCell_px;
  for (int i = 0; i < options.sizes; ++i, cell_px *= kDenseSizeFactor) {
    const double margin_px = kCells / 2 * cell_px;
    if (2 * margin_px > std::min(size.width, size.height)) break;
    const Planes planes = OrientationPlanes(image, cell_px);
    for (double y = margin_px; y <= size.height - margin_px; y += options.step_px) {
      for (double x = margin_px; x <= size.width - margin_px; x += options.step_px) {
        Raw raw = Sample(planes, x, y, cell_px);
        if (raw.norm <= kDenseMinContrast) continue;
        AppendDescriptor(raw, features.descriptors);
        features.keypoints.push_back({static_cast<float>(x / shrink), static_cast<float>(y / shrink),
                                      static_cast<float>(cell_px / 3 / shrink), 0.0F});
      }
    }
  }
  return features;
}

}  // namespace victorious
