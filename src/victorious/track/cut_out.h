// Pieces of a picture, turned upright and brought to a size.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/box.h"

namespace victorious {

/// A rectangle that may be turned.
struct TurnedBox {
  Eigen::Vector2d centre;  ///< px
  double width = 0;        ///< px, along its own x
  double height = 0;       ///< px, along its own y
  double turn_rad = 0;     ///< of its x, from the picture's +x towards +y

  [[nodiscard]] double Area() const { return width * height; }
  /// The same centre and turn, `factor` times as wide and as high.
  [[nodiscard]] TurnedBox Scaled(double factor) const;
  /// The upright box around the ellipse that touches its sides: for an object without corners at its box's corners, and
  /// little changed by a small turn.
  [[nodiscard]] Box Upright() const;
};

/// The box, not turned.
TurnedBox Unturned(const Box& box);

/// A size in px of this shape and about this area, whose sides are whole cells, at least two.
cv::Size WholeCells(double width, double height, double area_px2);

/// A picture, halved again and again: pieces of any size come out of it at the same cost. Shares the picture.
class Levels {
 public:
  Levels() = default;
  /// @param image  8-bit, not empty
  explicit Levels(const cv::Mat& image);

  [[nodiscard]] const cv::Mat& image() const { return levels_.front(); }
  [[nodiscard]] bool empty() const { return levels_.empty(); }
  [[nodiscard]] std::size_t count() const { return levels_.size(); }
  /// 1 / 2^level of the picture's size, what is left after whole pixels cut off.
  [[nodiscard]] const cv::Mat& operator[](std::size_t level) const { return levels_[level]; }

 private:
  std::vector<cv::Mat> levels_;
};

/// What the box encloses, turned upright and brought to a size; beyond the image its edge goes on.
cv::Mat CutOut(const Levels& image, const TurnedBox& box, cv::Size size);

}  // namespace victorious
