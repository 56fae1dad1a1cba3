#include "testing/town_pieces.h"

#include <algorithm>
#include <cmath>

#include "victorious/geometry/angles.h"

namespace victorious::testing {
namespace {

const cv::Point2d kSunlight(0.8, 0.6);  // direction of the shadows in the image

/// Brightness of a slope that faces along (x, y) of the image; 1 for a horizontal surface.
double Sunlit(double x, double y) { return 1.0 - 0.22 * (x * kSunlight.x + y * kSunlight.y); }

void Tiles(Pencil& pencil, cv::Point2d corner, cv::Point2d down, double length, const Colour& colour, Random& random) {
  constexpr double kRow = 9;
  constexpr double kTile = 13;
  const int rows = std::max(1, static_cast<int>(std::abs(down.y) / kRow));
  const double step = down.y / rows;
  for (int row = 0; row < rows; ++row) {
    const double y = corner.y + row * step;
    for (double x = corner.x - (row % 2) * kTile / 2; x < corner.x + length; x += kTile) {
      const double left = std::max(x, corner.x);
      const double right = std::min(x + kTile, corner.x + length);
      if (right - left < 2) continue;
      pencil.Box((left + right) / 2, y + step / 2, right - left, kRow, Shade(colour, random.Uniform(0.86, 1.1)));
    }
    pencil.Line({corner.x, y + step}, {corner.x + length, y + step}, Shade(colour, 0.72), 1);
  }
}

void Chimney(Pencil& pencil, double x, double y) {
  pencil.Box(x + 6, y + 4, 18, 14, Colour(50, 50, 55));
  pencil.Box(x, y, 16, 14, Colour(80, 95, 150));
  pencil.Frame(x, y, 16, 14, Colour(140, 150, 170), 2);
  pencil.Disc(x, y, 3.5, Colour(25, 25, 30));
}

void PaintHouse(Pencil& pencil, const TownPiece& piece, Random& random) {
  const Colour roof = PickColour(
      {{60, 75, 165}, {70, 85, 140}, {85, 90, 100}, {60, 70, 110}, {105, 110, 125}, {60, 95, 150}, {95, 85, 75}},
      random);
  const double w = piece.width;
  const double h = piece.height;
  const double towards = std::cos(piece.angle_rad) * kSunlight.y - std::sin(piece.angle_rad) * kSunlight.x;
  for (const double side : {-1.0, 1.0}) {
    const Colour lit = Shade(roof, 1.0 - 0.25 * side * towards);
    pencil.Box(0, side * h / 4, w, h / 2, lit);
    Tiles(pencil, {-w / 2, 0}, {0, side * h / 2}, w, lit, random);
    if (random.Uniform() < 0.6) {
      const double x = random.Uniform(-0.35, 0.35) * w;
      pencil.Box(x, side * h / 4, 22, 17, Shade(roof, 0.5));
      pencil.Box(x, side * h / 4, 17, 12, Colour(150, 130, 95));
      pencil.Line({x - 8, side * h / 4 + 5}, {x + 8, side * h / 4 - 5}, Colour(225, 215, 195), 2);
    }
    pencil.Box(0, side * (h / 2 - 1), w, 4, Colour(165, 168, 170));
  }
  pencil.Box(0, 0, w, 5, Shade(roof, 1.3));
  pencil.Line({-w / 2, 3}, {w / 2, 3}, Shade(roof, 0.6), 1);
  pencil.Frame(0, 0, w, h, Shade(roof, 0.55), 1);
  const auto [chimney_x, chimney_y] = Uniforms(random, {{-0.4, 0.4}, {-0.2, 0.2}});
  Chimney(pencil, chimney_x * w, chimney_y * h);
  if (random.Uniform() < 0.35) {  // solar panels
    const double left = random.Uniform(-0.4, 0.0) * w;
    for (int i = 0; i < 6; ++i) {
      const int row = i / 3;
      const double x = left + (i % 3) * 25;
      const double y = h * 0.16 + row * 19;
      pencil.Box(x, y, 23, 17, Colour(105, 65, 40));
      for (int line = -1; line <= 1; ++line)
        pencil.Line({x + line * 6, y - 8}, {x + line * 6, y + 8}, Colour(160, 125, 100), 1);
      pencil.Frame(x, y, 23, 17, Colour(190, 190, 190), 1);
    }
  }
}

void PaintVent(Pencil& pencil, double x, double y, double side, Random& random) {
  pencil.Box(x + 5, y + 4, side, side, Colour(70, 70, 72));
  const Colour steel = PickColour({{190, 190, 188}, {160, 165, 165}, {205, 200, 195}}, random);
  pencil.Box(x, y, side, side, steel);
  pencil.Frame(x, y, side, side, Shade(steel, 0.6), 1);
  if (random.Uniform() < 0.6) {
    pencil.Disc(x, y, side * 0.38, Shade(steel, 0.35));
    for (int blade = 0; blade < 3; ++blade) {
      const double turn = random.Uniform(0, kPi);
      const cv::Point2d reach(side * 0.36 * std::cos(turn), side * 0.36 * std::sin(turn));
      pencil.Line(cv::Point2d(x, y) - reach, cv::Point2d(x, y) + reach, Shade(steel, 0.8), 2);
    }
  } else {
    for (double at = -side / 2 + 4; at < side / 2 - 2; at += 5) {
      pencil.Line({x - side / 2 + 3, y + at}, {x + side / 2 - 3, y + at}, Shade(steel, 0.5), 1);
    }
  }
}

void PaintHall(Pencil& pencil, const TownPiece& piece, Random& random) {
  const Colour roof =
      PickColour({{150, 152, 155}, {120, 122, 128}, {170, 175, 175}, {120, 135, 150}, {95, 98, 100}}, random);
  const double w = piece.width;
  const double h = piece.height;
  pencil.Box(0, 0, w, h, Shade(roof, 1.25));
  pencil.Box(0, 0, w - 14, h - 14, roof);
  for (double x = -w / 2 + random.Uniform(20, 40); x < w / 2 - 12; x += random.Uniform(34, 60)) {
    pencil.Line({x, -h / 2 + 7}, {x, h / 2 - 7}, Shade(roof, 0.86), 1);
  }
  const auto along = [&](double space) { return Range{std::min(0.0, space - w / 2), std::max(0.0, w / 2 - space)}; };
  const auto down = [&](double space) { return Range{std::min(0.0, space - h / 2), std::max(0.0, h / 2 - space)}; };
  const int patches = static_cast<int>(w * h / 9000);
  for (int i = 0; i < patches; ++i) {
    const auto [x, y, length, breadth, shade] =
        Uniforms(random, {along(50), down(50), {16, 80}, {16, 70}, {0.85, 1.12}});
    pencil.Box(x, y, length, breadth, Shade(roof, shade));
  }
  const auto [skylights, pipe] = Uniforms(random, {down(40), down(26)});
  for (double x = -w / 2 + 40; x < w / 2 - 40; x += 46) {
    pencil.Box(x, skylights, 30, 20, Shade(roof, 0.55));
    pencil.Box(x, skylights, 26, 16, random.Uniform() < 0.7 ? Colour(205, 195, 175) : Colour(140, 120, 95));
    pencil.Line({x - 12, skylights + 6}, {x + 12, skylights - 6}, Colour(235, 232, 225), 1);
  }

  pencil.Line({-w / 2 + 12, pipe + 4}, {w * 0.3, pipe + 4}, Shade(roof, 0.6), 3);
  pencil.Line({-w / 2 + 12, pipe}, {w * 0.3, pipe}, Colour(200, 202, 205), 5);
  const int vents = 2 + static_cast<int>(w * h / 14000);
  for (int i = 0; i < vents; ++i) {
    const auto [x, y, side] = Uniforms(random, {along(36), down(36), {18, 38}});
    PaintVent(pencil, x, y, side, random);
  }
  if (random.Uniform() < 0.4) {
    const auto [x, y] = Uniforms(random, {along(70), down(50)});
    pencil.Text(x, y, RandomLabel(4, random), 36, w * 0.6, Shade(roof, 0.6), 5);
  }
  pencil.Frame(0, 0, w, h, Shade(roof, 0.6), 1);
}

void PaintTree(Pencil& pencil, const TownPiece& piece, Random& random) {
  const Colour leaf = PickColour({{45, 95, 60}, {40, 80, 55}, {55, 110, 85}, {50, 105, 105}, {60, 85, 60}}, random);
  const double radius = piece.width / 2;
  const int blobs = 14 + static_cast<int>(radius * 1.2);
  pencil.Disc(0, 0, radius * 0.86, Shade(leaf, 0.72));
  for (int i = 0; i < blobs; ++i) {
    const double reach = radius * 0.92 * std::sqrt(random.Uniform());
    const double turn = random.Uniform(0, 2 * kPi);
    const double x = reach * std::cos(turn);
    const double y = reach * std::sin(turn);
    const double blob = radius * random.Uniform(0.1, 0.24);
    const double light = Sunlit(2 * x / radius, 2 * y / radius) * random.Uniform(0.85, 1.15);
    pencil.Disc(x + blob * 0.3, y + blob * 0.25, blob, Shade(leaf, 0.6 * light));
    pencil.Disc(x, y, blob, Shade(leaf, light));
    pencil.Disc(x - blob * 0.3, y - blob * 0.25, blob * 0.5, Shade(leaf, 1.22 * light));
  }
}

void PaintCar(Pencil& pencil, const TownPiece& piece, Random& random) {
  const Colour body = PickColour(
      {{40, 40, 170}, {170, 90, 40}, {215, 215, 215}, {60, 60, 62}, {150, 150, 155}, {60, 120, 60}, {50, 170, 215}},
      random);
  const double l = piece.width / 2;   // half the length, along x
  const double b = piece.height / 2;  // half the width
  const Colour glass(75, 62, 50);
  pencil.Fill({{-l, -b * 0.8},
               {-l * 0.92, -b},
               {l * 0.8, -b},
               {l, -b * 0.6},
               {l, b * 0.6},
               {l * 0.8, b},
               {-l * 0.92, b},
               {-l, b * 0.8}},
              body);
  pencil.Fill({{l * 0.42, -b * 0.82}, {l * 0.18, -b * 0.7}, {l * 0.18, b * 0.7}, {l * 0.42, b * 0.82}}, glass);
  pencil.Fill({{-l * 0.78, -b * 0.75}, {-l * 0.58, -b * 0.68}, {-l * 0.58, b * 0.68}, {-l * 0.78, b * 0.75}}, glass);
  pencil.Box(-l * 0.2, 0, l * 0.7, b * 1.4, Shade(body, 1.12));
  for (const double side : {-1.0, 1.0}) {
    pencil.Line({-l * 0.55, side * b * 0.86}, {l * 0.3, side * b * 0.86}, glass, 2);
    pencil.Box(l * 0.93, side * b * 0.55, 4, 8, Colour(215, 240, 245));
    pencil.Box(-l * 0.95, side * b * 0.65, 3, 9, Colour(40, 40, 160));
    pencil.Line({l * 0.45, side * b * 0.5}, {l * 0.9, side * b * 0.42}, Shade(body, 0.75), 1);
  }
  if (random.Uniform() < 0.25) {  // a roof rack
    for (double x = -l * 0.5; x < l * 0.12; x += 8) pencil.Line({x, -b * 0.6}, {x, b * 0.6}, Shade(body, 0.5), 2);
  }
}

Pencil At(const cv::Mat& image, const TownPiece& piece, cv::Point2d shift = {}) {
  return {image, piece.centre + shift, piece.angle_rad};
}

void PaintFootprint(Pencil pencil, const TownPiece& piece, const Colour& value) {
  if (piece.kind == TownPiece::Kind::kTree) {
    pencil.Disc(0, 0, piece.width * 0.46, value);
  } else {
    pencil.Box(0, 0, piece.width, piece.height, value);
  }
}

}  // namespace

void PaintShadow(const cv::Mat& mask, const TownPiece& piece, const Colour& value) {
  for (double reach = 2; reach <= piece.shadow_px; reach += 4) {
    PaintFootprint(At(mask, piece, kSunlight * reach), piece, value);
  }
}

void PaintPiece(const cv::Mat& colour, const cv::Mat& texture, const TownPiece& piece, Random& random) {
  Pencil pencil = At(colour, piece);
  double strength = 0;
  switch (piece.kind) {
    case TownPiece::Kind::kHouse:
      PaintHouse(pencil, piece, random), strength = 16;
      break;
    case TownPiece::Kind::kHall:
      PaintHall(pencil, piece, random), strength = 14;
      break;
    case TownPiece::Kind::kTree:
      PaintTree(pencil, piece, random), strength = 26;
      break;
    case TownPiece::Kind::kCar:
      PaintCar(pencil, piece, random), strength = 4;
      break;
  }
  PaintFootprint(At(texture, piece), piece, Colour::all(strength));
}

}  // namespace victorious::testing
