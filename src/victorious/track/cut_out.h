// track/: rotated boxes, image pyramids, and crops that are resampled to a given size.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"

namespace victorious {

/// A rotated rectangle.
struct RotatedBox {
  Eigen::Vector2d centre;   ///< px
  double width = 0;         ///< px, along the box's x axis
  double height = 0;        ///< px, along the box's y axis
  double rotation_rad = 0;  ///< of the box's x axis, from the image's +x towards +y

  [[nodiscard]] double Area() const { return width * height; }
  /// The box with the same centre and rotation and `factor` times the width and height.
  [[nodiscard]] RotatedBox Scaled(double factor) const;
  /// The axis-aligned bounding box of the inscribed ellipse. Objects seldom reach the corners of their box, and this
  /// box changes little with a small rotation.
  [[nodiscard]] Box EllipseBounds() const;
};

/// The same box, with rotation 0.
RotatedBox ToRotatedBox(const Box& box);

/// @return a size, px, of this aspect ratio and about this area; each side is a multiple of kCell_px, from 2 to 64
/// cells
cv::Size CellAlignedSize(double width, double height, double area_px2);

/// An image pyramid: crops of any size have the same cost. Level 0 shares the pixels of the image.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// @param image  8-bit, not empty
  explicit ImagePyramid(const cv::Mat& image);

  [[nodiscard]] const cv::Mat& image() const { return levels_.front(); }
  [[nodiscard]] bool empty() const { return levels_.empty(); }
  [[nodiscard]] std::size_t count() const { return levels_.size(); }
  /// The image at 1 / 2^level of its size, rounded down.
  [[nodiscard]] const cv::Mat& operator[](std::size_t level) const { return levels_[level]; }

 private:
  std::vector<cv::Mat> levels_;
};

/// The content of the box, axis-aligned and resampled to `size` px (bilinear); the border is replicated.
cv::Mat CropRotated(const ImagePyramid& image, const RotatedBox& box, cv::Size size);

}  // namespace victorious
