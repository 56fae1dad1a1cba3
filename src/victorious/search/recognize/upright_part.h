// Private to recognize/, for ShapeSearch: parts of a frame in which the vertical points upwards.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>

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

/// A frame at several scales, a quarter of an octave apart, each averaged over areas: parts of it are cut at any scale
/// without averaging them anew. Makes each level at its first use. Thread-safe.
class FramePyramid {
 public:
  /// @param grey  the frame, CV_8UC1; must outlive this
  explicit FramePyramid(const cv::Mat& grey) : grey_(grey) {}
  FramePyramid(const FramePyramid&) = delete;
  FramePyramid& operator=(const FramePyramid&) = delete;

  [[nodiscard]] const cv::Mat& frame() const { return grey_; }

  /// The smallest level that is at least as large as the frame at this scale, and at most the frame.
  [[nodiscard]] const cv::Mat& LevelFor(double scale) const;

 private:
  static constexpr int kLevelsPerOctave = 4;
  static constexpr std::size_t kLevels = 16;  // below the frame

  const cv::Mat& grey_;
  mutable std::array<std::once_flag, kLevels> once_;
  mutable std::array<cv::Mat, kLevels> levels_;
};

/// Empty beside the frame.
/// @param size_px  of the part, in pixels of the frame
/// @param scale    pixels of the part per pixel of the frame
[[nodiscard]] UprightPart CutUpright(const FramePyramid& frame, const Eigen::Vector2d& centre_px,
                                     const cv::Size2d& size_px, double scale, double lean_rad);

}  // namespace victorious
