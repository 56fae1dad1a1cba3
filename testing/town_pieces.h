// The objects on the ground of a drawn town: houses, halls, trees, cars. The footprint of each casts a shadow.
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
  double width = 0;    ///< px; twice the radius of a tree
  double height = 0;   ///< px, along the piece's own y
  double angle_rad = 0;
  double shadow_px = 0;  ///< length of the shadow
};

/// Paints the shadow of a piece with `value` into a CV_8U mask.
void PaintShadow(const cv::Mat& mask, const TownPiece& piece, const Colour& value);

/// Paints the piece, and its texture strength (CV_8U, see ApplyTexture).
void PaintPiece(const cv::Mat& colour, const cv::Mat& texture, const TownPiece& piece, Random& random);

}  // namespace victorious::testing
