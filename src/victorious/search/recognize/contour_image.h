// Private to recognize/, for ContourSearch and ShapeSearch: the edges of an image. An edge pixel is a maximum of the
// gradient's magnitude along the gradient, of kMinEdgeGradient grey levels a pixel or more, in an enlarged image as
// much less. Orientations are those of the edge's normal; the sign of the contrast does not count.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace victorious {

inline constexpr double kMinEdgeGradient = 2.5;  ///< grey levels a pixel
inline constexpr int kEdgeOrientations = 16;     ///< bins of half a turn
inline constexpr int kEdgeReach_px = 2;          ///< a point this near an edge pixel lies on the edge

/// Gradients of an image, and its edge pixels.
struct ImageEdges {
  cv::Mat x, y;       ///< CV_32FC1, grey levels a pixel
  cv::Mat magnitude;  ///< CV_32FC1
  cv::Mat is_edge;    ///< CV_8UC1: 0 or 255
};

/// Of the image as it is, not smoothed.
/// @param grey          CV_8UC1
/// @param min_gradient  of an edge, grey levels a pixel
[[nodiscard]] ImageEdges FindEdges(const cv::Mat& grey, double min_gradient = kMinEdgeGradient);

/// The orientation of a normal, of `bins` in half a turn.
[[nodiscard]] int OrientationBin(double x, double y, int bins);

/// An image smoothed by a Gaussian of 1 px, and its edges.
class ContourImage {
 public:
  /// @param grey          CV_8UC1; not changed
  /// @param min_gradient  of an edge, grey levels a pixel
  explicit ContourImage(const cv::Mat& grey, double min_gradient = kMinEdgeGradient);

  /// Smoothed.
  [[nodiscard]] const cv::Mat& grey() const { return grey_; }
  [[nodiscard]] Eigen::Vector2d centre_px() const { return {grey_.cols / 2.0, grey_.rows / 2.0}; }

  /// The gradient along a unit vector, grey levels a pixel, without its sign; 0 beside the image and where there is
  /// none of about this orientation.
  [[nodiscard]] double GradientAlong(const Eigen::Vector2d& at_px, const Eigen::Vector2d& normal) const;

  /// True if an edge of about this orientation is within kEdgeReach_px.
  [[nodiscard]] bool HasEdge(const Eigen::Vector2d& at_px, int orientation) const;

  /// For each orientation, the fraction of places in a part of the image for which HasEdge is true, at least 0.01.
  [[nodiscard]] std::array<double, kEdgeOrientations> EdgeFractions(const cv::Rect& part) const;

 private:
  cv::Mat grey_;
  double min_gradient_;
  ImageEdges edges_;
  std::array<cv::Mat, kEdgeOrientations> near_;  // CV_8UC1: HasEdge
  std::array<cv::Mat, kEdgeOrientations> sums_;  // CV_32SC1: integral images of these
};

}  // namespace victorious
