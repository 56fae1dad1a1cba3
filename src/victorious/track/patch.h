// A small picture around a point, and how much another place looks like it.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace victorious {

/// Grey levels on a square grid about a point, shifted to mean 0 and scaled to norm 1: what is left does not depend on
/// brightness and contrast. All zeros where the picture is flat.
class Patch {
 public:
  /// @param grey    CV_8UC1
  /// @param centre  px
  /// @param side_px  of the grid, odd
  /// @param linear  picture from grid: turns and scales the grid
  Patch(const cv::Mat& grey, const Eigen::Vector2d& centre, int side_px, const Eigen::Matrix2d& linear);

  /// Normalised correlation, -1 to 1; 0 if either is flat. Both must have the same side.
  [[nodiscard]] double Likeness(const Patch& other) const;

  [[nodiscard]] bool IsFlat() const { return flat_; }

 private:
  std::vector<float> values_;
  bool flat_ = false;
};

}  // namespace victorious
