// Of image/ and video/: image orientation by EXIF (JPEG, PNG) or by the display matrix (MP4, MKV), and the rotation to
// upright.
#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// The eight values of EXIF's Orientation tag: the operation that makes the stored image upright.
enum class Orientation {
  kUpright = 1,
  kMirror = 2,  ///< left and right swapped
  kRotate180 = 3,
  kFlip = 4,           ///< top and bottom swapped
  kTranspose = 5,      ///< reflection in the main diagonal
  kRotate90 = 6,       ///< clockwise
  kAntiTranspose = 7,  ///< reflection in the other diagonal
  kRotate270 = 8,      ///< clockwise
};

/// Converts EXIF's value; kUpright for values outside 1..8.
[[nodiscard]] Orientation OrientationFromExif(std::uint32_t value);

/// Returns the orientation nearest to FFmpeg's 3 x 3 display matrix: point in display = [x y 1] * matrix, y downwards.
[[nodiscard]] Orientation OrientationFromDisplayMatrix(std::span<const std::int32_t, 9> matrix);

/// Returns the upright image; shares the pixels of `stored` for kUpright.
[[nodiscard]] cv::Mat RotateUpright(const cv::Mat& stored, Orientation orientation);

/// Returns true if the operation swaps width and height.
[[nodiscard]] bool SwapsWidthAndHeight(Orientation orientation);

/// Returns the clockwise rotation in degrees, without the reflection: 0, 90, 180 or 270.
[[nodiscard]] int ClockwiseRotationDeg(Orientation orientation);

}  // namespace victorious
