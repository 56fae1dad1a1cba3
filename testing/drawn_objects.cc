#include "testing/drawn_objects.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "testing/drawing.h"
#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious::testing {
namespace {

constexpr int kDetail = 2;     // drawn at twice the size, then downsampled by area
constexpr double kMargin = 2;  // transparent border in px, for interpolation at the edge

using Corners = std::vector<cv::Point2d>;

const Colour kInk(28, 26, 24);
const Colour kChalk(232, 236, 238);

/// Completes one half of an outline that is symmetric about x = 0.
Corners MirrorOutline(Corners half) {
  for (auto i = half.size(); i-- > 0;) half.push_back({-half[i].x, half[i].y});
  return half;
}

Corners Rectangle(double width, double height) {
  return {{-width / 2, -height / 2}, {width / 2, -height / 2}, {width / 2, height / 2}, {-width / 2, height / 2}};
}

void Rivets(Pencil& pencil, cv::Point2d from, cv::Point2d to, int count, const Colour& colour) {
  for (int i = 0; i < count; ++i) {
    const cv::Point2d at = from + (to - from) * (count > 1 ? i / (count - 1.0) : 0.5);
    pencil.Disc(at.x, at.y, 1.9, Shade(colour, 0.45));
    pencil.Disc(at.x - 0.5, at.y - 0.5, 0.9, Shade(colour, 1.7));
  }
}

void HazardStripes(Pencil& pencil, double x, double y, double width, double height, double stripe) {
  pencil.Box(x, y, width, height, Colour(40, 200, 240));
  for (double left = -width / 2; left + stripe <= width / 2; left += 2 * stripe) {
    const double lean = std::min(height / 2, width / 2 - left - stripe);
    pencil.Fill({{x + left, y + height / 2},
                 {x + left + lean, y - height / 2},
                 {x + left + lean + stripe, y - height / 2},
                 {x + left + stripe, y + height / 2}},
                kInk);
  }
}

void Barcode(Pencil& pencil, double x, double y, double width, double height, Random& random) {
  pencil.Box(x, y, width, height, kChalk);
  for (double at = -width / 2 + 3; at < width / 2 - 4;) {
    const double bar = random.Uniform(1.2, 4.0);
    pencil.Box(x + at + bar / 2, y, bar, height - 6, kInk);
    at += bar + random.Uniform(1.5, 4.0);
  }
}

void Emblem(Pencil& pencil, double x, double y, double radius, Random& random) {
  const Colour back = PickColour({{40, 40, 190}, {180, 80, 30}, {60, 140, 40}, {30, 170, 220}}, random);
  pencil.Disc(x, y, radius, kChalk);
  pencil.Disc(x, y, radius * 0.88, back);
  const int points = 3 + static_cast<int>(random.Below(4));
  const double turn = random.Uniform(0, kPi);
  const double waist = random.Uniform(0.28, 0.5);
  Corners star;
  for (int i = 0; i < 2 * points; ++i) {
    const double reach = radius * (i % 2 == 0 ? 0.8 : waist);
    star.push_back({x + reach * std::cos(turn + i * kPi / points), y + reach * std::sin(turn + i * kPi / points)});
  }
  pencil.Fill(star, kChalk);
}

/// Small plates, hatches and labels at random positions, which break the symmetry of an object.
void Fittings(Pencil& pencil, double width, double height, int count, const Colour& base, Random& random) {
  for (int i = 0; i < count; ++i) {
    const auto [w, h] = Uniforms(random, {{6, 18}, {5, 14}});
    const double x = random.Uniform(-width / 2 + w, width / 2 - w);
    const double y = random.Uniform(-height / 2 + h, height / 2 - h);
    const Colour colour = random.Uniform() < 0.6 ? Shade(base, random.Uniform(0.5, 1.6))
                                                 : PickColour({kChalk, {40, 60, 190}, {60, 190, 230}, kInk}, random);
    pencil.Box(x + 1, y + 1, w, h, Shade(base, 0.45));
    pencil.Box(x, y, w, h, colour);
    switch (random.Below(4)) {
      case 0:
        pencil.Line({x - w / 2, y}, {x + w / 2, y}, Shade(colour, 0.4), 1);
        break;
      case 1:
        pencil.Disc(x + random.Uniform(-2, 2), y, 2, Shade(colour, 0.35));
        break;
      case 2:
        pencil.Text(x, y, RandomLabel(2, random), h * 0.6, w * 0.8, Shade(colour, 0.3), 1);
        break;
      default:
        pencil.Line({x - w / 2, y - h / 2}, {x + w / 2, y + h / 2}, Shade(colour, 0.5), 1);
        break;
    }
  }
}

void Scratches(Pencil& pencil, double width, double height, int count, const Colour& base, Random& random) {
  for (int i = 0; i < count; ++i) {
    const auto [x, y, along, down] =
        Uniforms(random, {{-width / 2, width / 2}, {-height / 2, height / 2}, {-14, 14}, {-14, 14}});
    pencil.Line({x, y}, {x + along, y + down}, Shade(base, random.Uniform() < 0.5 ? 0.6 : 1.5), 0.5);
  }
}

void PaintCrate(Pencil& pencil, Random& random) {
  constexpr double kSide = 176;
  const Colour wood =
      PickColour({{70, 120, 165}, {70, 100, 80}, {130, 90, 60}, {60, 70, 140}, {110, 130, 140}}, random);
  const int planks = 5 + static_cast<int>(random.Below(4));
  const double plank = kSide / planks;
  for (int i = 0; i < planks; ++i) {
    const double x = -kSide / 2 + (i + 0.5) * plank;
    const Colour shade = Shade(wood, random.Uniform(0.78, 1.2));
    pencil.Box(x, 0, plank, kSide, shade);
    for (int grain = 0; grain < 4; ++grain) {
      const auto [across, from, lean, length] = Uniforms(random, {{-0.4, 0.4}, {-80, 40}, {-3, 3}, {20, 60}});
      const double g = x + across * plank;
      pencil.Line({g, from}, {g + lean, from + length}, Shade(shade, 0.8), 0.5);
    }
    pencil.Line({x - plank / 2, -kSide / 2}, {x - plank / 2, kSide / 2}, Shade(wood, 0.4), 1);
  }
  Fittings(pencil, 140, 140, 7, wood, random);
  const double rail = random.Uniform(16, 24);
  const Colour board = Shade(wood, random.Uniform(0.6, 1.35));
  const double lean = random.Uniform() < 0.5 ? 1 : -1;
  if (random.Uniform() < 0.6) {
    pencil.Fill({{-80 * lean, -80 + rail}, {-80 * lean, -80}, {80 * lean, 80 - rail}, {80 * lean, 80}}, board);
    pencil.Line({-80 * lean, -80 + rail}, {80 * lean, 80}, Shade(board, 0.5), 1);
  }
  for (const double side : {-1.0, 1.0}) {
    const double at = side * (kSide - rail) / 2;
    pencil.Box(0, at, kSide, rail, Shade(board, 1 + 0.08 * side));
    pencil.Box(at, 0, rail, kSide - 2 * rail, Shade(board, 1 - 0.08 * side));
    pencil.Frame(0, at, kSide - 2, rail, Shade(board, 0.5), 1);
    pencil.Frame(at, 0, rail, kSide - 2 * rail, Shade(board, 0.5), 1);
  }
  const int nails = 6 + static_cast<int>(random.Below(5));
  for (const double side : {-1.0, 1.0}) {
    const double at = side * (kSide - rail) / 2;
    Rivets(pencil, {-80, at - 4}, {80, at - 4}, nails, board);
    Rivets(pencil, {at, -60}, {at, 60}, nails - 2, board);
  }
  const Colour ink = random.Uniform() < 0.5 ? kInk : kChalk;
  const std::string large = RandomLabel(3, random);
  const std::string small = RandomLabel(6, random);
  const auto [up, large_x, small_x, code_x, code_width, emblem_x, emblem_radius] =
      Uniforms(random, {{-38, -18}, {-10, 10}, {-20, 20}, {-35, 5}, {36, 56}, {38, 50}, {13, 18}});
  pencil.Text(large_x, up, large, 34, 118, ink, 5);
  pencil.Text(small_x, up + 36, small, 13, 110, ink, 2);
  Barcode(pencil, code_x, up + 62, code_width, 20, random);
  Emblem(pencil, emblem_x, up + 66, emblem_radius, random);
  Scratches(pencil, 170, 170, 30, wood, random);
}

void PaintSign(Pencil& pencil, Random& random) {
  constexpr double kWidth = 192;
  constexpr double kHeight = 136;
  const Colour back =
      PickColour({{150, 70, 30}, {60, 110, 30}, {40, 40, 170}, {30, 160, 210}, {200, 200, 200}}, random);
  const Colour ink = back[0] + back[1] + back[2] > 380 ? kInk : kChalk;
  const Colour other = PickColour({{40, 200, 240}, {60, 60, 210}, {210, 160, 60}, {90, 190, 90}}, random);
  pencil.Box(0, 0, kWidth, kHeight, Shade(back, 0.5));
  pencil.Box(0, 0, kWidth - 8, kHeight - 8, back);
  pencil.Frame(0, 0, kWidth - 16, kHeight - 16, ink, 2);
  Fittings(pencil, 170, 110, 6, back, random);
  const auto [stripe, stripes_x, stripes_width, corner_x, corner_y] =
      Uniforms(random, {{8, 14}, {-24, 24}, {90, 128}, {-60, -30}, {-30, 0}});
  HazardStripes(pencil, stripes_x, kHeight / 2 - 20, stripes_width, 16, stripe);
  pencil.Fill({{-84, -56}, {corner_x, -56}, {-84, corner_y}}, other);
  const double side = random.Uniform() < 0.5 ? 1 : -1;
  const auto [emblem_y, emblem_radius, small_x] = Uniforms(random, {{-30, -20}, {18, 24}, {-8, 8}});
  Emblem(pencil, side * 62, emblem_y, emblem_radius, random);
  pencil.Text(-side * 22, -30, RandomLabel(4, random), 32, 108, ink, 6);
  pencil.Text(small_x, 10, RandomLabel(7, random), 20, 150, ink, 3);
  Barcode(pencil, -side * 64, 34, 34, 12, random);
  for (int i = 0; i < 4; ++i) {
    const double x = side * 34 + 13 * i - 20;
    pencil.Fill({{x, 30}, {x + 9, 36}, {x, 42}, {x + 3, 36}}, other);
  }
  Rivets(pencil, {-90, -62}, {90, -62}, 9, back);
  Rivets(pencil, {-90, 62}, {90, 62}, 7 + static_cast<int>(random.Below(5)), back);
  Scratches(pencil, 180, 125, 26, back, random);
}

const Corners& TruckHalf() {
  static const Corners half = {{30, -98}, {38, -92}, {40, -72}, {54, -74}, {56, -62},
                               {41, -60}, {41, -52}, {50, -50}, {50, 96},  {46, 98}};
  return half;
}

void PaintCab(Pencil& pencil, const Colour& body, Random& random) {
  pencil.Fill(MirrorOutline({{30, -98}, {38, -92}, {41, -52}}), body);
  pencil.Fill(MirrorOutline({{40, -72}, {54, -74}, {56, -62}, {41, -60}}), Shade(body, 0.55));
  pencil.Fill(MirrorOutline({{28, -80}, {34, -70}}), Colour(70, 60, 45));  // windscreen
  pencil.Line({-22, -72}, {-4, -79}, Colour(190, 180, 160), 1.5);
  pencil.Frame(0, -61, 60, 14, Shade(body, 0.6), 1);
  pencil.Text(0, -61, RandomLabel(4, random), 10, 54, kChalk, 2);
  for (const double side : {-1.0, 1.0}) {
    pencil.Disc(side * 29, -93, 3.5, Colour(200, 240, 250));
    pencil.Box(side * 20, -88, 14, 3, Shade(body, 0.5));
  }
  pencil.Disc(random.Uniform(-16, 16), -90, 3, Colour(30, 130, 240));
}

void PaintTruck(Pencil& pencil, Random& random) {
  const Colour body =
      PickColour({{60, 110, 70}, {50, 60, 170}, {160, 110, 50}, {40, 150, 200}, {140, 140, 140}}, random);
  pencil.Fill(MirrorOutline(TruckHalf()), Shade(body, 0.5));
  PaintCab(pencil, body, random);
  pencil.Box(0, 23, 100, 146, Shade(body, 0.85));
  pencil.Box(0, 23, 90, 136, Colour(80, 88, 92));
  for (double y = -42; y < 90; y += 9) {
    pencil.Line({-44, y}, {44, y + random.Uniform(-1, 1)}, Colour(58, 62, 66), 1);
  }
  for (const double side : {-1.0, 1.0}) Rivets(pencil, {side * 47.5, -46}, {side * 47.5, 92}, 16, body);
  double y = -34;
  while (y < 70) {  // rows of cargo, of one or two pieces
    const double depth = random.Uniform(24, 40);
    const double split = random.Uniform() < 0.75 ? random.Uniform(-18, 18) : 44;
    for (const auto& [left, right] : {std::pair{-43.0, split - 1}, std::pair{split + 1, 43.0}}) {
      if (right - left < 10 || random.Uniform() < 0.08) continue;
      const double x = (left + right) / 2;
      const double w = right - left;
      const double at = y + depth / 2;
      const Colour load = PickColour(
          {{70, 120, 165}, {60, 130, 60}, {150, 150, 155}, {50, 50, 160}, {190, 140, 60}, {60, 170, 210}}, random);
      pencil.Box(x + 1.5, at + 1.5, w, depth - 3, Colour(40, 44, 46));
      pencil.Box(x, at, w, depth - 4, load);
      pencil.Frame(x, at, w - 4, depth - 8, Shade(load, 0.65), 1);
      switch (random.Below(4)) {
        case 0:
          Barcode(pencil, x, at, w * 0.6, depth * 0.5, random);
          break;
        case 1:
          pencil.Text(x, at, RandomLabel(3, random), depth * 0.4, w * 0.8, Shade(load, 0.3), 2.5);
          break;
        case 2:
          Emblem(pencil, x, at, std::min(w, depth) * 0.36, random);
          break;
        default:
          pencil.Line({left, y + 3}, {right, y + depth - 4}, Shade(load, 1.5), 2);
          pencil.Line({left, y + depth - 4}, {right, y + 3}, Shade(load, 0.5), 2);
      }
    }
    y += depth;
  }
  HazardStripes(pencil, 0, 93, 92, 7, 6);
  Scratches(pencil, 90, 180, 20, body, random);
}

const Corners& AircraftHalf() {
  static const Corners half = {{5, -90}, {10, -78}, {12, -46}, {97, -34}, {98, -10}, {92, -4},
                               {12, -2}, {8, 52},   {40, 66},  {40, 82},  {6, 80},   {3, 90}};
  return half;
}

void PaintAircraft(Pencil& pencil, Random& random) {
  const Colour skin =
      PickColour({{225, 225, 220}, {170, 175, 180}, {90, 140, 90}, {200, 190, 120}, {60, 180, 220}}, random);
  const Colour paint = PickColour({{50, 50, 190}, {170, 80, 30}, {40, 120, 40}, {30, 130, 230}, {60, 50, 60}}, random);
  pencil.Fill(MirrorOutline(AircraftHalf()), skin);
  for (const double side : {-1.0, 1.0}) {  // wings: panels, flaps, tips
    for (double x = 22; x < 92; x += random.Uniform(8, 14)) {
      pencil.Line({side * x, -44 + x * 0.1}, {side * x, -4}, Shade(skin, 0.72), 1);
    }
    pencil.Line({side * 14, -12}, {side * 94, -13}, Shade(skin, 0.6), 1);
    pencil.Line({side * 14, -36}, {side * 94, -28}, Shade(skin, 0.8), 1);
    const double tip = random.Uniform(76, 86);
    pencil.Fill({{side * tip, -36.5}, {side * 96, -34}, {side * 97, -10}, {side * 92, -5}, {side * tip, -4}}, paint);
    const double stripe = random.Uniform(20, 30);
    pencil.Fill({{side * stripe, -44}, {side * (stripe + 7), -43}, {side * (stripe + 7), -3}, {side * stripe, -3}},
                paint);
    Rivets(pencil, {side * 16, -8}, {side * 90, -8}, 11 + static_cast<int>(random.Below(6)), skin);
    pencil.Line({side * 8, 74}, {side * 39, 74}, Shade(skin, 0.6), 1);
    pencil.Box(side * random.Uniform(20, 34), 68, 6, 12, paint);
  }
  pencil.Text(-54, -24, RandomLabel(3, random), 15, 40, kInk, 3);
  const double emblem = random.Uniform(9, 12);
  Emblem(pencil, 55, -23, emblem, random);
  pencil.Fill(MirrorOutline({{5, -90}, {9.5, -78}, {10, -64}}), paint);  // nose
  pencil.Fill(MirrorOutline({{7, -58}, {9, -48}, {8, -28}, {6, -24}}), Colour(80, 60, 40));
  pencil.Line({-5, -54}, {3, -46}, Colour(220, 210, 190), 1.5);
  for (double y = -18; y < 54; y += random.Uniform(6, 11)) pencil.Line({-9, y}, {9, y}, Shade(skin, 0.7), 1);
  const auto [hatch_y, hatch_height] = Uniforms(random, {{10, 34}, {8, 14}});
  pencil.Box(0, hatch_y, 14, hatch_height, paint);
  pencil.Line({0, 50}, {0, 90}, Shade(paint, 0.7), 4);
  for (int i = 0; i < 10; ++i) {
    const auto [x, y, w, h, shade] = Uniforms(random, {{-88, 88}, {-32, -12}, {4, 9}, {3, 7}, {0.55, 0.85}});
    pencil.Box(x, y, w, h, Shade(skin, shade));
  }
}

struct Design {
  std::string_view name;
  double width;
  double height;
  Corners outline;
  void (*paint)(Pencil&, Random&);
};

const Design& GetDesign(ObjectKind kind) {
  static const Design designs[kNumObjectKinds] = {
      {"crate", 176, 176, Rectangle(176, 176), PaintCrate},
      {"truck", 120, 200, MirrorOutline(TruckHalf()), PaintTruck},
      {"sign", 192, 136, Rectangle(192, 136), PaintSign},
      {"aircraft", 200, 184, MirrorOutline(AircraftHalf()), PaintAircraft},
  };
  return designs[static_cast<int>(kind)];
}

}  // namespace

std::string_view Name(ObjectKind kind) { return GetDesign(kind).name; }

SyntheticObject DrawObject(ObjectKind kind, std::uint64_t seed) {
  const Design& design = GetDesign(kind);
  Random random(seed * kNumObjectKinds + static_cast<std::uint64_t>(kind));
  const cv::Size size(static_cast<int>(design.width + 2 * kMargin), static_cast<int>(design.height + 2 * kMargin));
  const cv::Point2d middle(size.width / 2.0, size.height / 2.0);

  cv::Mat large(size * kDetail, CV_8UC3, GetDesign(kind).outline.size() > 4 ? Colour(90, 90, 90) : kInk);
  cv::Mat large_alpha = cv::Mat::zeros(size * kDetail, CV_8U);
  Pencil pencil(large, middle * kDetail, 0.0, kDetail);
  design.paint(pencil, random);
  pencil.On(large_alpha).Fill(design.outline, Colour::all(255));

  cv::Mat grime = SmoothNoise(large.size(), 36, random);
  grime += 0.8 * SmoothNoise(large.size(), 9, random);
  ApplyTexture(large, grime, cv::Mat(large.size(), CV_8U, cv::Scalar(18)));

  SyntheticObject object;
  cv::Mat colour;
  cv::Mat alpha;
  cv::resize(large, colour, size, 0, 0, cv::INTER_AREA);
  cv::resize(large_alpha, alpha, size, 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>{colour, alpha}, object.image);
  for (const cv::Point2d& corner : design.outline)
    object.outline.emplace_back(corner.x + middle.x, corner.y + middle.y);
  return object;
}

}  // namespace victorious::testing
