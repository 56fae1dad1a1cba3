#include "victorious/search/recognize/contour_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace victorious {
namespace {

constexpr double kSmoothing_px = 1;
constexpr double kMinAlignment = 0.85;  // cosine between a gradient and the normal of a contour

cv::Mat Smoothed(const cv::Mat& grey) {
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {}, kSmoothing_px);
  return smooth;
}

}  // namespace

ImageEdges FindEdges(const cv::Mat& grey, double min_gradient) {
  ImageEdges edges;
  constexpr double kSobelGain = 8;
  cv::Sobel(grey, edges.x, CV_32F, 1, 0, 3, 1 / kSobelGain);
  cv::Sobel(grey, edges.y, CV_32F, 0, 1, 3, 1 / kSobelGain);
  cv::magnitude(edges.x, edges.y, edges.magnitude);
  edges.is_edge = cv::Mat::zeros(grey.size(), CV_8U);
  for (int row = 1; row < grey.rows - 1; ++row) {
    for (int column = 1; column < grey.cols - 1; ++column) {
      const float magnitude = edges.magnitude.at<float>(row, column);
      if (magnitude < min_gradient) continue;
      const int right = static_cast<int>(std::lround(edges.x.at<float>(row, column) / magnitude));
      const int down = static_cast<int>(std::lround(edges.y.at<float>(row, column) / magnitude));
      if (magnitude >= edges.magnitude.at<float>(row + down, column + right) &&
          magnitude > edges.magnitude.at<float>(row - down, column - right)) {
        edges.is_edge.at<std::uint8_t>(row, column) = 255;
      }
    }
  }
  return edges;
}

int OrientationBin(double x, double y, int bins) {
  const auto bin = static_cast<int>(std::lround(std::atan2(y, x) / std::numbers::pi * bins)) % bins;
  return bin < 0 ? bin + bins : bin;
}

ContourImage::ContourImage(const cv::Mat& grey, double min_gradient)
    : grey_(Smoothed(grey)), min_gradient_(min_gradient), edges_(FindEdges(grey_, min_gradient)) {
  for (cv::Mat& near : near_) near = cv::Mat::zeros(grey.size(), CV_8U);
  for (int row = 0; row < grey.rows; ++row) {
    for (int column = 0; column < grey.cols; ++column) {
      if (edges_.is_edge.at<std::uint8_t>(row, column) == 0) continue;
      const int bin =
          OrientationBin(edges_.x.at<float>(row, column), edges_.y.at<float>(row, column), kEdgeOrientations);
      for (int i = kEdgeOrientations - 1; i <= kEdgeOrientations + 1; ++i) {
        near_[static_cast<std::size_t>((bin + i) % kEdgeOrientations)].at<std::uint8_t>(row, column) = 1;
      }
    }
  }
  constexpr int kSide_px = 2 * kEdgeReach_px + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {kSide_px, kSide_px});
  for (std::size_t i = 0; i < near_.size(); ++i) {
    cv::dilate(near_[i], near_[i], disc);
    cv::integral(near_[i], sums_[i], CV_32S);
  }
}

double ContourImage::GradientAlong(const Eigen::Vector2d& at_px, const Eigen::Vector2d& normal) const {
  const int column = static_cast<int>(std::floor(at_px.x()));
  const int row = static_cast<int>(std::floor(at_px.y()));
  if (column < 0 || row < 0 || column >= grey_.cols || row >= grey_.rows) return 0;
  const double magnitude = edges_.magnitude.at<float>(row, column);
  if (magnitude < min_gradient_) return 0;
  const double along =
      std::abs(edges_.x.at<float>(row, column) * normal.x() + edges_.y.at<float>(row, column) * normal.y());
  return along >= kMinAlignment * magnitude ? along : 0;
}

bool ContourImage::HasEdge(const Eigen::Vector2d& at_px, int orientation) const {
  const int column = static_cast<int>(std::floor(at_px.x()));
  const int row = static_cast<int>(std::floor(at_px.y()));
  if (column < 0 || row < 0 || column >= grey_.cols || row >= grey_.rows) return false;
  return near_[static_cast<std::size_t>(orientation)].at<std::uint8_t>(row, column) != 0;
}

std::array<double, kEdgeOrientations> ContourImage::EdgeFractions(const cv::Rect& part) const {
  constexpr double kMin = 0.01;  // not 0: a test on an empty background proves little
  constexpr double kMax = 0.9;
  std::array<double, kEdgeOrientations> fractions{};
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const cv::Mat& sum = sums_[i];
    const int count = sum.at<int>(part.y + part.height, part.x + part.width) -
                      sum.at<int>(part.y, part.x + part.width) - sum.at<int>(part.y + part.height, part.x) +
                      sum.at<int>(part.y, part.x);
    fractions[i] = std::clamp(count / static_cast<double>(part.area()), kMin, kMax);
  }
  return fractions;
}

}  // namespace victorious
