// Axis-aligned boxes in pixels: x to the right, y down, the frame's left-top corner at (0, 0), the first pixel's centre
// at (0.5, 0.5).
#pragma once

#include <algorithm>

namespace victorious {

struct Box {
  double x = 0;       ///< left edge, px
  double y = 0;       ///< top edge, px
  double width = 0;   ///< px
  double height = 0;  ///< px

  [[nodiscard]] double Area() const { return width * height; }
  [[nodiscard]] bool IsEmpty() const { return !(width > 0 && height > 0); }
  [[nodiscard]] bool Contains(double px, double py) const {
    return px >= x && py >= y && px < x + width && py < y + height;
  }
  bool operator==(const Box&) const = default;
};

/// The box of a whole frame or image.
inline Box FrameBox(double width_px, double height_px) { return {0, 0, width_px, height_px}; }

/// The intersection; empty if the boxes do not overlap.
inline Box Intersection(const Box& a, const Box& b) {
  const double x0 = std::max(a.x, b.x);
  const double y0 = std::max(a.y, b.y);
  const double x1 = std::min(a.x + a.width, b.x + b.width);
  const double y1 = std::min(a.y + a.height, b.y + b.height);
  return {x0, y0, std::max(0.0, x1 - x0), std::max(0.0, y1 - y0)};
}

/// Intersection over union, 0 to 1; 0 if both are empty.
inline double IntersectionOverUnion(const Box& a, const Box& b) {
  const double common = Intersection(a, b).Area();
  const double joined = a.Area() + b.Area() - common;
  return joined > 0 ? common / joined : 0.0;
}

}  // namespace victorious
