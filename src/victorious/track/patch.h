// track/: a normalised grey patch around a point, compared by NCC.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace victorious {

/// Grey levels on a square grid around a point, normalised to mean 0 and norm 1, and so invariant to brightness and
/// contrast. All zeros if flat (standard deviation below one grey level).
class Patch {
 public:
  /// @param grey    CV_8UC1
  /// @param centre  px
  /// @param side_px  side of the grid, odd
  /// @param linear  image from grid: rotates and scales the grid
  Patch(const cv::Mat& grey, const Eigen::Vector2d& centre, int side_px, const Eigen::Matrix2d& linear);

  /// @return the NCC, -1 to 1; 0 if either patch is flat. Both must have the same side.
  [[nodiscard]] double NccScore(const Patch& other) const;

  [[nodiscard]] bool IsFlat() const { return flat_; }

 private:
  std::vector<float> values_;
  bool flat_ = false;
};

}  // namespace victorious
