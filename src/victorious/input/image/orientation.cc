#include "victorious/input/image/orientation.h"

#include <cstdlib>

#include <opencv2/core.hpp>

namespace victorious {

Orientation OrientationFromExif(std::uint32_t value) {
  return value >= 1 && value <= 8 ? static_cast<Orientation>(value) : Orientation::kUpright;
}

Orientation OrientationFromDisplayMatrix(std::span<const std::int32_t, 9> matrix) {
  // The stored x axis maps to (a, b) on the display, the stored y axis to (c, d).
  const std::int64_t a = matrix[0];
  const std::int64_t b = matrix[1];
  const std::int64_t c = matrix[3];
  const std::int64_t d = matrix[4];
  if (std::abs(a) + std::abs(d) >= std::abs(b) + std::abs(c)) {
    if (a >= 0) return d >= 0 ? Orientation::kUpright : Orientation::kFlip;
    return d >= 0 ? Orientation::kMirror : Orientation::kRotate180;
  }
  if (b >= 0) return c >= 0 ? Orientation::kTranspose : Orientation::kRotate90;
  return c >= 0 ? Orientation::kRotate270 : Orientation::kAntiTranspose;
}

cv::Mat RotateUpright(const cv::Mat& stored, Orientation orientation) {
  cv::Mat upright;
  switch (orientation) {
    case Orientation::kUpright:
      return stored;
    case Orientation::kMirror:
      cv::flip(stored, upright, 1);
      return upright;
    case Orientation::kRotate180:
      cv::rotate(stored, upright, cv::ROTATE_180);
      return upright;
    case Orientation::kFlip:
      cv::flip(stored, upright, 0);
      return upright;
    case Orientation::kTranspose:
      cv::transpose(stored, upright);
      return upright;
    case Orientation::kRotate90:
      cv::rotate(stored, upright, cv::ROTATE_90_CLOCKWISE);
      return upright;
    case Orientation::kAntiTranspose: {
      cv::Mat turned;
      cv::rotate(stored, turned, cv::ROTATE_180);
      cv::transpose(turned, upright);
      return upright;
    }
    case Orientation::kRotate270:
      cv::rotate(stored, upright, cv::ROTATE_90_COUNTERCLOCKWISE);
      return upright;
  }
  return stored;
}

bool SwapsWidthAndHeight(Orientation orientation) { return orientation >= Orientation::kTranspose; }

int ClockwiseRotationDeg(Orientation orientation) {
  switch (orientation) {
    case Orientation::kUpright:
    case Orientation::kMirror:
      return 0;
    case Orientation::kTranspose:
    case Orientation::kRotate90:
      return 90;
    case Orientation::kRotate180:
    case Orientation::kFlip:
      return 180;
    case Orientation::kAntiTranspose:
    case Orientation::kRotate270:
      return 270;
  }
  return 0;
}

}  // namespace victorious
