// tools/: parts common to many vehicles: wheels, windows, lamps, mirrors, ladders, aerials.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "assets/make/asset.h"

namespace victorious::assets {

inline const Bgr kRubber = Rgb(44, 43, 42);
inline const Bgr kDarkMetal = Rgb(58, 60, 62);
inline const Bgr kSteel = Rgb(150, 153, 156);
inline const Colour kWindow{42, 36, 30};
inline const Colour kWhite{222, 226, 226};
inline const Colour kBlack{34, 33, 32};

/// A tyre with its rim around the x axis, centred at the origin, facing +x.
Mesh WheelMesh(float radius, float width, int segments = 16);

/// Wheels on both sides at each z, with their centres at +-x. The last `rear_twins` axles have two wheels per side.
struct Wheels {
  float radius = 0.4F;
  float width = 0.25F;
  float x = 0.8F;
  std::vector<float> z;
  Bgr rim = Rgb(120, 122, 124);
  int bolts = 6;
  int rear_twins = 0;
};
void AddWheels(Asset& asset, const Wheels& wheels);

/// A side view whose lower edge has round wheel arches, from the rear (minimum z) to the front.
Polygon SideOutline(const Polygon& upper, float sill, const std::vector<float>& axles, float axle_height, float radius);

/// A pane with a diagonal reflection and a rubber frame.
void DrawWindow(Stencil& stencil, const std::vector<cv::Point2d>& corners);
/// Draws the same on the left and on the right.
template <typename Draw>
void DrawOnBothSides(const Canvas& canvas, std::string_view part, const Draw& draw) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    Stencil colour = canvas.Colour(part, side);
    Stencil shade = canvas.Shade(part, side);
    draw(colour, shade);
  }
}
/// A door with its handle at the rear edge.
void DrawDoor(Stencil& colour, Stencil& shade, double a0, double b0, double a1, double b1);
void DrawHeadlamps(Stencil& front, double x, double y, double radius);
void DrawTailLamps(Stencil& back, double x, double y, double width, double height);

Mesh Mirrors(float x, float y, float z, float height = 0.22F);
/// Two rails with rungs, from one end to the other, `width` wide along x.
Mesh Ladder(const Vec3& from, const Vec3& to, float width, float rung_step = 0.32F, float radius = 0.03F);
Mesh Aerial(float x, float y, float z, float height);
/// A rack of bars around a rectangle, `height` above `y`.
Mesh RoofRack(float x0, float z0, float x1, float z1, float y, float height);

/// Tapers a mesh: x shrinks by the fraction `fraction` per metre above `y0`.
Mesh Tapered(Mesh mesh, float y0, float fraction);

}  // namespace victorious::assets
