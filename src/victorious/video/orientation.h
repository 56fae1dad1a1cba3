// Private to video/: how a stored picture must be turned to stand upright, for EXIF (JPEG, PNG) and for the
// display matrix of MP4 and MKV alike.
#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

namespace victorious {

/// The eight values of EXIF's Orientation tag: what has to be done to the stored picture.
enum class Orientation {
  kUpright = 1,
  kMirror = 2,  ///< left and right change places
  kTurn180 = 3,
  kFlip = 4,           ///< top and bottom change places
  kTranspose = 5,      ///< about the main diagonal
  kTurn90 = 6,         ///< clockwise
  kAntiTranspose = 7,  ///< about the other diagonal
  kTurn270 = 8,        ///< clockwise
};

/// The orientation of EXIF's number; upright for anything outside 1..8.
[[nodiscard]] Orientation OrientationFromExif(std::uint32_t value);

/// The orientation nearest to FFmpeg's 3 x 3 display matrix: point in display = [x y 1] * matrix, y downwards.
[[nodiscard]] Orientation OrientationFromDisplayMatrix(std::span<const std::int32_t, 9> matrix);

/// The picture upright; the same pixels, not copied, where nothing has to be done.
[[nodiscard]] cv::Mat TurnUpright(const cv::Mat& stored, Orientation orientation);

/// Whether width and height change places.
[[nodiscard]] bool SwapsSides(Orientation orientation);

/// The clockwise turn in it, a mirror left aside: 0, 90, 180, 270.
[[nodiscard]] int ClockwiseTurnDeg(Orientation orientation);

}  // namespace victorious
