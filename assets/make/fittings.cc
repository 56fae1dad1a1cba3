#include "assets/make/fittings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace victorious::assets {

Mesh WheelMesh(float radius, float width, int segments) {
  const float h = width / 2;
  return Revolve({{-h * 0.8F, 0.02F},
                  {-h * 0.8F, radius * 0.6F},
                  {-h, radius * 0.72F},
                  {-h, radius * 0.93F},
                  {-h * 0.75F, radius},
                  {h * 0.75F, radius},
                  {h, radius * 0.93F},
                  {h, radius * 0.72F},
                  {h * 0.7F, radius * 0.6F},
                  {h * 0.45F, radius * 0.5F},
                  {h * 0.5F, radius * 0.22F},
                  {h * 0.85F, radius * 0.18F},
                  {h * 0.85F, 0.02F}},
                 Axis::kX, segments);
}

void AddWheels(Asset& asset, const Wheels& wheels) {
  Part& part = asset.Add("wheel", WheelMesh(wheels.radius, wheels.width),
                         Wheel(wheels.radius, wheels.radius * 0.62F, wheels.rim, wheels.bolts));
  part.share_sides = true;
  part.density = 0.8F;
  part.places.clear();
  for (std::size_t i = 0; i < wheels.z.size(); ++i) {
    const bool twins = i + static_cast<std::size_t>(wheels.rear_twins) >= wheels.z.size();
    for (const float shift : twins ? std::vector<float>{0, -wheels.width * 1.12F} : std::vector<float>{0}) {
      part.places.push_back(At(wheels.x + shift, wheels.radius, wheels.z[i]));
      part.places.push_back(At(-wheels.x - shift, wheels.radius, wheels.z[i]) * Turn(Axis::kY, 180));
    }
  }
}

Polygon SideOutline(const Polygon& upper, float sill, const std::vector<float>& axles, float axle_height,
                    float radius) {
  Polygon outline = upper;  // from the bottom front over the top to the bottom rear
  const float half = std::sqrt(std::max(0.0F, radius * radius - (sill - axle_height) * (sill - axle_height)));
  const float angle = std::asin((sill - axle_height) / radius) * 57.29578F;
  for (const float z : axles) {
    outline.emplace_back(z - half, sill);
    const Polygon arc = Arc(z, axle_height, radius, 180 - angle, angle, 9);
    outline.insert(outline.end(), arc.begin() + 1, arc.end() - 1);
    outline.emplace_back(z + half, sill);
  }
  return outline;
}

void DrawWindow(Stencil& stencil, const std::vector<cv::Point2d>& corners) {
  stencil.Fill(corners, kWindow);
  // The reflection: the pane's shape, shrunk towards its first corner.
  std::vector<cv::Point2d> gleam;
  for (const cv::Point2d& corner : corners) gleam.push_back(corners[0] + (corner - corners[0]) * 0.5);
  stencil.Fill(gleam, {112, 98, 84});
  std::vector<cv::Point2d> inner;
  for (const cv::Point2d& corner : corners) inner.push_back(corners[0] + (corner - corners[0]) * 0.3);
  stencil.Fill(inner, {72, 62, 54});
  std::vector<cv::Point2d> frame = corners;
  frame.push_back(corners[0]);
  stencil.Path(frame, {26, 26, 26}, 0.03);
}

void DrawDoor(Stencil& colour, Stencil& shade, double a0, double b0, double a1, double b1) {
  shade.Frame(a0, b0, a1, b1, kGroove, 0.025);
  const double rear = std::min(a0, a1), high = std::max(b0, b1);
  colour.Box(rear + 0.08, high - 0.14, rear + 0.26, high - 0.09, {40, 40, 40});
}

void DrawHeadlamps(Stencil& front, double x, double y, double radius) {
  for (const double side : {-x, x}) {
    front.Disc(side, y, radius * 1.25, {52, 52, 52});
    front.Disc(side, y, radius, {218, 224, 222});
    front.Disc(side, y + radius * 0.2, radius * 0.45, {168, 172, 170});
  }
}

void DrawTailLamps(Stencil& back, double x, double y, double width, double height) {
  for (const double side : {-x, x}) {
    back.Box(side - width / 2, y - height / 2, side + width / 2, y + height / 2, {38, 34, 168});
    back.Box(side - width / 2, y - height / 2, side + width / 2, y - height / 6, {60, 120, 215});
  }
}

Mesh Mirrors(float x, float y, float z, float height) {
  Mesh one = Box({x + 0.14F, y, z}, {0.05F, height, 0.14F}, 0.015F);
  one.Add(Cylinder({x - 0.05F, y - height * 0.3F, z}, {x + 0.14F, y - height * 0.1F, z}, 0.015F, 6));
  return Mesh().AddBothSides(one);
}

Mesh Ladder(const Vec3& from, const Vec3& to, float width, float rung_step, float radius) {
  const Vec3 half(width / 2, 0, 0);
  Mesh ladder = Tube({from - half, to - half}, radius, 6);
  ladder.Add(Tube({from + half, to + half}, radius, 6));
  const int rungs = std::max(2, static_cast<int>((to - from).norm() / rung_step));
  for (int i = 0; i < rungs; ++i) {
    const Vec3 at = from + (to - from) * ((static_cast<float>(i) + 0.5F) / static_cast<float>(rungs));
    ladder.Add(Cylinder(at - half, at + half, radius * 0.8F, 5));
  }
  return ladder;
}

Mesh Aerial(float x, float y, float z, float height) {
  Mesh mesh = Cylinder({x, y, z}, {x, y + 0.15F, z}, 0.05F, 8);
  return mesh.Add(Cylinder({x, y + 0.1F, z}, {x, y + height, z - height * 0.12F}, 0.014F, 5));
}

Mesh RoofRack(float x0, float z0, float x1, float z1, float y, float height) {
  const float top = y + height;
  Mesh rack = Tube({{x0, top, z0}, {x1, top, z0}, {x1, top, z1}, {x0, top, z1}, {x0, top, z0}}, 0.02F, 5);
  constexpr int kBars = 5;
  for (int i = 0; i <= kBars; ++i) {
    const float z = z0 + (z1 - z0) * static_cast<float>(i) / kBars;
    rack.Add(Tube({{x0, y, z}, {x0, top, z}}, 0.016F, 5)).Add(Tube({{x1, y, z}, {x1, top, z}}, 0.016F, 5));
    rack.Add(Tube({{x0, y + height * 0.4F, z}, {x1, y + height * 0.4F, z}}, 0.016F, 5));
  }
  return rack;
}

Mesh Tapered(Mesh mesh, float y0, float fraction) {
  return Bent(std::move(mesh),
              [=](const Vec3& p) { return Vec3(p.x() * (1 - fraction * std::max(0.0F, p.y() - y0)), p.y(), p.z()); });
}

}  // namespace victorious::assets
