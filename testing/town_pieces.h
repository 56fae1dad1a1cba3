// What stands on the ground of a drawn town: houses, halls, trees, cars. Each has a footprint that casts a shadow.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "testing/drawing.h"
#include "victorious/base/random.h"

namespace victorious::testing {

struct TownPiece {
  enum class Kind { kHouse, kHall, kTree, kCar };
  Kind kind = Kind::kHouse;
  cv::Point2d centre;  ///< px on the ground
  double width = 0;    ///< px; a tree's radius is half of it
  double height = 0;   ///< px, along the piece's own y
  double angle_rad = 0;
  double shadow_px = 0;  ///< how far the shadow reaches
};

/// Where a piece's shadow falls, painted with `value` into a CV_8U mask.
void PaintShadow(const cv::Mat& mask, const TownPiece& piece, const Colour& value);

/// The piece itself, and how strongly it is textured (CV_8U, see ApplyTexture).
void PaintPiece(const cv::Mat& colour, const cv::Mat& texture, const TownPiece& piece, Random& random);

}  // namespace victorious::testing
