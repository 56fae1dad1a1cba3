// Private to recognize/, for ShapeSearch: parts of a frame in which the vertical points upwards.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace victorious {

/// A part of the frame at another scale, turned so that the vertical points upwards.
struct UprightPart {
  cv::Mat grey;      ///< CV_8UC1; its sides are even
  double scale = 1;  ///< pixels of the part per pixel of the frame
  double lean_rad = 0;
  Eigen::Vector2d centre_px;  ///< in the frame

  [[nodiscard]] Eigen::Vector2d centre_in_part_px() const { return {0.5 * grey.cols, 0.5 * grey.rows}; }
  [[nodiscard]] Eigen::Vector2d ToFrame(const Eigen::Vector2d& in_part) const;
  [[nodiscard]] Eigen::Vector2d FromFrame(const Eigen::Vector2d& in_frame) const;
  [[nodiscard]] UprightPart AtHalfScale() const;
};

/// Empty beside the frame.
/// @param grey     the frame, CV_8UC1
/// @param size_px  of the part, in pixels of the frame
/// @param scale    pixels of the part per pixel of the frame
[[nodiscard]] UprightPart CutUpright(const cv::Mat& grey, const Eigen::Vector2d& centre_px, const cv::Size2d& size_px,
                                     double scale, double lean_rad);

}  // namespace victorious
