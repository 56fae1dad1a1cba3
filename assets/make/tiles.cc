// tools/: streets and squares as tiles of kTileSide_m. The centre is (kMiddle, kMiddle); roads run up and down the
// image.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "assets/make/ground.h"

namespace victorious::assets {
namespace {

using testing::Pencil;

constexpr int kTile_px = 1024;
constexpr double kSide = kTileSide_m;
constexpr double kMiddle = kSide / 2;
constexpr double kHalfRoad = 4.5;
constexpr double kHalfStreet = 7;  // with its pavements
const Colour kLineWhite{208, 214, 216};
const Colour kLineYellow{58, 176, 214};

Ground Bare(const Material& material, std::uint64_t seed) { return {kTileSide_m, kTile_px, material, seed, false}; }

void Kerbs(Ground& ground, double from, double to, bool along) {
  ground.Draw([&](Pencil& pencil) {
    for (const double side : {-kHalfRoad - 0.1, kHalfRoad + 0.1}) {
      const double at = kMiddle + side;
      for (double stone = from; stone < to - 0.01; stone += 1) {
        const Colour grey = testing::Shade({158, 162, 164}, 0.88 + 0.05 * (std::lround(stone * 7 + side) % 4));
        const double end = std::min(stone + 0.96, to);
        if (along) {
          pencil.Fill({{at - 0.1, stone}, {at + 0.1, stone}, {at + 0.1, end}, {at - 0.1, end}}, grey);
        } else {
          pencil.Fill({{stone, at - 0.1}, {stone, at + 0.1}, {end, at + 0.1}, {end, at - 0.1}}, grey);
        }
      }
    }
  });
}

void Age(Ground& ground) {
  ground.Patches(3, NewAsphalt);
  ground.Stains(18, 0.2, 0.7, 0.65);
  ground.Cracks(9, 4, {46, 45, 44});
  ground.TarSeals(3, 5);
  ground.Specks(140, 0.05, 0.16, {{190, 198, 200}, {70, 116, 140}, {60, 80, 96}});
}

/// Verge, pavement, carriageway and kerbs of a straight street, without markings.
Ground Street(std::uint64_t seed, const Material& pavement) {
  Ground ground = Bare(Asphalt, seed);
  Age(ground);
  for (const double side : {0.0, 1.0}) {
    const auto box = [&](const Material& material, double near, double far) {
      ground.LayBox(material, side == 0 ? near : kSide - far, 0, side == 0 ? far : kSide - near, kSide);
    };
    box(pavement, kMiddle - kHalfStreet, kMiddle - kHalfRoad);
    box(Grass, 0, kMiddle - kHalfStreet);
  }
  for (const double lane : {-2.25, 2.25}) {
    for (const double wheel : {-0.8, 0.8})
      ground.Wear(kMiddle + lane + wheel, -1, kMiddle + lane + wheel, kSide + 1, 0.7, 0.86);
  }
  for (const double side : {-kHalfRoad, kHalfRoad})
    ground.Wear(kMiddle + side, -1, kMiddle + side, kSide + 1, 0.5, 0.75);
  Kerbs(ground, 0, kSide, true);
  ground.Draw([&](Pencil& pencil) {
    for (const double side : {-kHalfStreet, kHalfStreet})
      pencil.Line({kMiddle + side, -1}, {kMiddle + side, kSide + 1}, {132, 138, 140}, 0.12);
  });
  return ground;
}

void Dashes(Ground& ground, double x, double from, double to, double dash, double gap, const Colour& colour) {
  ground.Paint(colour, [&](Pencil& pencil, const Colour& ink) {
    for (double y = from; y < to; y += dash + gap) pencil.Box(x, y + dash / 2, 0.15, dash, ink);
  });
}

void Solid(Ground& ground, cv::Point2d from, cv::Point2d to, const Colour& colour, double width = 0.14) {
  ground.Paint(colour, [&](Pencil& pencil, const Colour& ink) { pencil.Line(from, to, ink, width); });
}

/// An arrow on a lane, 4 m long; `direction` -1 points up the image, 1 down. `turn` bends its head aside.
void Arrow(Ground& ground, double x, double y, double direction, double turn) {
  ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
    pencil.Box(x, y, 0.22, 3, ink);
    const double head = y + direction * 1.5;
    if (turn == 0) {
      pencil.Fill({{x - 0.5, head}, {x + 0.5, head}, {x, head + direction * 1.1}}, ink);
    } else {
      pencil.Box(x + turn * 0.35, head, 0.8, 0.25, ink);
      pencil.Fill({{x + turn * 0.7, head - 0.5}, {x + turn * 0.7, head + 0.5}, {x + turn * 1.5, head}}, ink);
    }
  });
}

void Words(Ground& ground, double x, double y, const std::string& text, double height, const Colour& colour) {
  ground.Paint(colour,
               [&](Pencil& pencil, const Colour& ink) { pencil.Text(x, y, text, height, 8, ink, height * 0.16); });
}

/// Bars of a zebra crossing over the road: at `at` along the image's columns, or across them.
void Zebra(Ground& ground, double at, bool along) {
  ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
    for (double bar = kMiddle - kHalfRoad + 0.5; bar < kMiddle + kHalfRoad - 0.2; bar += 1) {
      along ? pencil.Box(bar, at, 0.5, 2.6, ink) : pencil.Box(at, bar, 2.6, 0.5, ink);
    }
  });
}

Ground RoadStraight() {
  Ground ground = Street(11, Slabs);
  Dashes(ground, kMiddle, 0, kSide, 3, 3, kLineWhite);
  for (const double side : {-4.2, 4.2})
    Solid(ground, {kMiddle + side, -1}, {kMiddle + side, kSide + 1}, kLineWhite, 0.1);
  Arrow(ground, kMiddle - 2.25, 15, 1, 0);
  Arrow(ground, kMiddle + 2.25, 8, -1, 1);
  ground.Manhole(kMiddle - 1.1, 5.2, 0.36);
  ground.Manhole(kMiddle + 2.9, 19.3, 0.36);
  ground.Drain(kMiddle - 4.1, 10);
  ground.Drain(kMiddle + 4.1, 21);
  return ground;
}

Ground RoadBus() {
  Ground ground = Street(12, Brick);
  ground.LayBox(
      [](float x, float y, float period) { return Bgr(Mix(NewAsphalt(x, y, period), Rgb(132, 66, 54), 0.55F)); },
      kMiddle - kHalfRoad + 0.1, 0, kMiddle - 1.3, kSide);
  for (const double side : {-0.15, 0.15})
    Solid(ground, {kMiddle + 1.2 + side, -1}, {kMiddle + 1.2 + side, kSide + 1}, kLineYellow, 0.12);
  Solid(ground, {kMiddle - 1.3, -1}, {kMiddle - 1.3, kSide + 1}, kLineWhite, 0.25);
  Words(ground, kMiddle - 2.85, 14, "BUS", 1.1, kLineWhite);
  Words(ground, kMiddle - 2.85, 16, "LANE", 0.9, kLineWhite);
  Words(ground, kMiddle + 2.9, 6, "30", 1.4, kLineWhite);
  ground.Manhole(kMiddle, 9.5, 0.36);
  ground.Manhole(kMiddle + 3.2, 15.5, 0.3);
  ground.Drain(kMiddle + 4.1, 3);
  return ground;
}

Ground RoadCrossing() {
  Ground ground = Street(13, Slabs);
  Zebra(ground, kMiddle, true);
  for (const double way : {-1.0, 1.0}) {
    ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
      pencil.Box(kMiddle + way * 2.25, kMiddle + way * 3, 4.2, 0.4, ink);
    });
    ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {  // zigzags before the crossing
      for (double y = 3.6; y < 11.5; y += 1.6) {
        for (const double side : {-4.1, 4.1}) {
          pencil.Line({kMiddle + side, kMiddle + way * y}, {kMiddle + side * 0.93, kMiddle + way * (y + 0.8)}, ink,
                      0.1);
          pencil.Line({kMiddle + side * 0.93, kMiddle + way * (y + 0.8)}, {kMiddle + side, kMiddle + way * (y + 1.6)},
                      ink, 0.1);
        }
      }
    });
    Dashes(ground, kMiddle, way < 0 ? 0 : kMiddle + 3.5, way < 0 ? kMiddle - 3.5 : kSide, 2, 1, kLineWhite);
  }
  Words(ground, kMiddle + 2.25, 19, "SLOW", 1.3, kLineWhite);
  ground.LayBox([](float x, float y, float period) { return Bgr(Mix(Slabs(x, y, period), Rgb(200, 170, 70), 0.45F)); },
                kMiddle - 7, kMiddle - 1.3, kMiddle - 4.8, kMiddle + 1.3);
  ground.LayBox([](float x, float y, float period) { return Bgr(Mix(Slabs(x, y, period), Rgb(200, 170, 70), 0.45F)); },
                kMiddle + 4.8, kMiddle - 1.3, kMiddle + 7, kMiddle + 1.3);
  ground.Manhole(kMiddle - 2.6, 4.4, 0.36);
  return ground;
}

/// Where two streets meet, all four ways or three (no way to the right).
Ground Junction(std::uint64_t seed, bool all_ways) {
  Ground ground = Bare(Asphalt, seed);
  Age(ground);
  const auto corners = [&](const Material& material, double half) {
    for (const double y : {0.0, kMiddle + half}) {
      ground.LayBox(material, 0, y, kMiddle - half, y + kMiddle - half);
      ground.LayBox(material, kMiddle + half, all_ways ? y : 0, kSide, all_ways ? y + kMiddle - half : kSide);
    }
  };
  corners(Slabs, kHalfRoad);
  corners(Grass, kHalfStreet);
  const double near = kMiddle - kHalfRoad, far = kMiddle + kHalfRoad;
  Kerbs(ground, 0, near, true);
  Kerbs(ground, far, kSide, true);
  Kerbs(ground, 0, near, false);
  if (all_ways) Kerbs(ground, far, kSide, false);
  if (!all_ways)
    ground.Draw([&](Pencil& pencil) { pencil.Line({far + 0.1, near}, {far + 0.1, far}, {150, 154, 156}, 0.2); });
  Zebra(ground, near - 2, true);
  Zebra(ground, far + 2, true);
  Zebra(ground, near - 2, false);
  if (all_ways) Zebra(ground, far + 2, false);
  ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
    pencil.Box(kMiddle + 2.25, far + 3.8, 4.3, 0.4, ink);
    pencil.Box(kMiddle - 2.25, near - 3.8, 4.3, 0.4, ink);
    pencil.Box(near - 3.8, kMiddle + 2.25, 0.4, 4.3, ink);
    if (all_ways) pencil.Box(far + 3.8, kMiddle - 2.25, 0.4, 4.3, ink);
  });
  if (all_ways) {  // the box to be kept clear
    ground.Paint(kLineYellow, [&](Pencil& pencil, const Colour& ink) {
      pencil.Frame(kMiddle, kMiddle, 7.6, 7.6, ink, 0.14);
      for (double at = -5.7; at < 6; at += 1.9) {
        const double from = std::max(-3.8, at - 3.8), to = std::min(3.8, at + 3.8);
        pencil.Line({kMiddle + from, kMiddle + at - from}, {kMiddle + to, kMiddle + at - to}, ink, 0.1);
        pencil.Line({kMiddle - from, kMiddle + at - from}, {kMiddle - to, kMiddle + at - to}, ink, 0.1);
      }
    });
  }
  Solid(ground, {kMiddle, far + 4}, {kMiddle, kSide + 1}, kLineWhite);
  Solid(ground, {kMiddle, -1}, {kMiddle, near - 4}, kLineWhite);
  Solid(ground, {-1, kMiddle}, {near - 4, kMiddle}, kLineWhite);
  if (all_ways) Solid(ground, {far + 4, kMiddle}, {kSide + 1, kMiddle}, kLineWhite);
  ground.Manhole(kMiddle - 1.6, kMiddle + 2.2, 0.38);
  ground.Drain(near + 0.4, far + 0.6);
  ground.Drain(far - 0.4, near - 0.6);
  return ground;
}

Ground Parking() {
  Ground ground = Bare(NewAsphalt, 15);
  ground.Patches(4, Asphalt);
  ground.Stains(40, 0.2, 0.8, 0.6);
  ground.Cracks(7, 4, {38, 37, 36});
  ground.Specks(130, 0.05, 0.15, {{190, 198, 200}, {70, 116, 140}});
  int number = 41;
  for (const double row : {2.7, 10.7, 13.7, 21.7}) {
    const double mouth = row < 5 || (row > 12 && row < 16) ? 1 : -1;  // the side cars drive in from
    ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
      for (double x = 1; x < 24; x += 2.75) pencil.Line({x, row - 2.5}, {x, row + 2.5}, ink, 0.12);
    });
    for (double x = 2.375; x < 22.5; x += 2.75)
      Words(ground, x, row + mouth * 1.8, std::to_string(number++), 0.6, kLineWhite);
  }
  ground.LayBox(Grass, 0, 12.0, 24, 12.4);
  ground.Draw([&](Pencil& pencil) { pencil.Frame(12, 12.2, 24.4, 0.7, {150, 154, 156}, 0.14); });
  Arrow(ground, 6, 7, -1, 1);
  Arrow(ground, 17, 17.7, 1, -1);
  ground.Manhole(12.5, 6.9, 0.36);
  ground.Drain(3, 17.6);
  ground.Drain(21, 6.6);
  return ground;
}

Ground Helipad() {
  Ground ground = Bare(Concrete, 16);
  ground.Stains(26, 0.3, 1.4, 0.7);
  ground.Cracks(8, 4, {92, 96, 98});
  ground.TarSeals(4, 5);
  ground.LayDisc(NewAsphalt, kMiddle, kMiddle, 9.6);
  ground.Stains(18, 0.3, 1.0, 0.7);
  ground.Paint(kLineYellow, [&](Pencil& pencil, const Colour& ink) {
    pencil.Ring(kMiddle, kMiddle, 9.2, ink, 0.5);
    pencil.Ring(kMiddle, kMiddle, 6.2, ink, 0.22);
  });
  ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
    pencil.Box(kMiddle - 1.8, kMiddle, 0.8, 6, ink);
    pencil.Box(kMiddle + 1.8, kMiddle, 0.8, 6, ink);
    pencil.Box(kMiddle, kMiddle, 3.6, 0.8, ink);
  });
  Words(ground, kMiddle, kMiddle + 7.6, "6.5t", 1.0, kLineWhite);
  Words(ground, 3.2, 2.4, "FATO 2", 0.9, kLineYellow);
  for (int i = 0; i < 16; ++i) {
    const double angle = i * 0.3927;
    ground.Draw([&](Pencil& pencil) {
      pencil.Disc(kMiddle + 10.3 * std::cos(angle), kMiddle + 10.3 * std::sin(angle), 0.22, {60, 60, 60});
      pencil.Disc(kMiddle + 10.3 * std::cos(angle), kMiddle + 10.3 * std::sin(angle), 0.13, {150, 210, 210});
    });
  }
  ground.Cracks(4, 3, {40, 40, 40});
  ground.Specks(90, 0.05, 0.15, {{190, 198, 200}, {70, 90, 100}});
  return ground;
}

Ground Apron() {
  Ground ground = Bare(Concrete, 17);
  ground.Stains(46, 0.3, 1.5, 0.68);
  ground.Cracks(10, 4, {92, 96, 98});
  ground.TarSeals(6, 5);
  for (int i = 0; i < 5; ++i) {
    const double x = ground.random().Uniform(8, 16);
    ground.Wear(x, -1, x + ground.random().Uniform(-2, 2), kSide + 1, 0.4, 0.7);  // rubber
  }
  Solid(ground, {kMiddle, -1}, {kMiddle, kSide + 1}, kLineYellow, 0.25);
  ground.Paint(kLineYellow, [&](Pencil& pencil, const Colour& ink) {
    for (int i = 0; i < 14; ++i) {
      const double a = i * 0.1122, b = (i + 1) * 0.1122;
      pencil.Line({24 - 12 * std::cos(a), 24 - 12 * std::sin(a)}, {24 - 12 * std::cos(b), 24 - 12 * std::sin(b)}, ink,
                  0.25);
    }
    pencil.Line({kMiddle - 2, 4}, {kMiddle + 2, 4}, ink, 0.3);
    pencil.Line({kMiddle - 1.5, 6}, {kMiddle + 1.5, 6}, ink, 0.2);
  });
  Words(ground, 4, 4, "B7", 2.0, kLineYellow);
  Words(ground, 19.5, 6, "NO ENTRY", 0.8, kLineWhite);
  ground.Paint({52, 56, 176}, [&](Pencil& pencil, const Colour& ink) {
    pencil.Line({1, 1}, {1, 23}, ink, 0.25);
    pencil.Line({23, 1}, {23, 23}, ink, 0.25);
    for (double y = 14; y < 22; y += 1) pencil.Line({1.2, y}, {5, y + 1.2}, ink, 0.15);
    pencil.Frame(3.1, 18.2, 3.8, 9, ink, 0.15);
  });
  for (const auto& [x, y] : {std::pair{7.0, 9.0}, {17.0, 9.0}, {7.0, 19.0}, {17.0, 19.0}}) {
    ground.Draw([&, x = x, y = y](Pencil& pencil) {
      pencil.Disc(x, y, 0.25, {70, 72, 74});
      pencil.Ring(x, y, 0.16, {150, 152, 154}, 0.05);
    });
  }
  ground.Draw([&](Pencil& pencil) { pencil.Frame(19.5, 15.5, 1.6, 1.0, {62, 62, 62}, 0.1); });
  ground.Manhole(9.4, 21.2, 0.4);
  ground.Specks(100, 0.05, 0.15, {{70, 80, 86}, {196, 202, 204}});
  return ground;
}

Ground Court() {
  Ground ground = Bare(Brick, 18);
  const auto pale = [](float x, float y, float period) {
    return Bgr(Mix(Slabs(x, y, period), Rgb(190, 184, 170), 0.4F));
  };
  for (const double at : {0.0, 8.0, 16.0}) {
    ground.LayBox(pale, at, 0, at + 0.8, kSide);
    ground.LayBox(pale, 0, at, kSide, at + 0.8);
  }
  ground.LayDisc(Slabs, kMiddle + 0.4, kMiddle + 0.4, 3.2);
  ground.LayDisc(Brick, kMiddle + 0.4, kMiddle + 0.4, 2.4);
  ground.LayDisc(pale, kMiddle + 0.4, kMiddle + 0.4, 1.2);
  for (const auto& [x, y] : {std::pair{4.4, 4.4}, {20.4, 4.4}, {4.4, 20.4}, {20.4, 20.4}}) {
    ground.LayBox(Slabs, x - 1.4, y - 1.4, x + 1.4, y + 1.4);
    ground.LayBox(Dirt, x - 1.1, y - 1.1, x + 1.1, y + 1.1);
  }
  ground.Stains(34, 0.25, 1.0, 0.74);
  ground.Specks(220, 0.05, 0.16, {{52, 96, 128}, {60, 120, 150}, {190, 196, 198}});
  ground.Drain(12.4, 4.4);
  ground.Drain(12.4, 20.4);
  ground.Manhole(7, 14, 0.35);
  return ground;
}

Ground Yard() {
  Ground ground = Bare(Gravel, 19);
  ground.TyreTracks(7, 0.74);
  ground.LayBox(Concrete, 1.5, 1.5, 9.5, 8.2);
  ground.Draw([&](Pencil& pencil) { pencil.Frame(5.5, 4.85, 8, 6.7, {92, 96, 98}, 0.15); });
  ground.Paint(kLineYellow, [&](Pencil& pencil, const Colour& ink) {
    pencil.Frame(5.5, 4.85, 6.6, 5.4, ink, 0.14);
    pencil.Line({2.2, 2.15}, {8.8, 7.55}, ink, 0.14);
    pencil.Line({8.8, 2.15}, {2.2, 7.55}, ink, 0.14);
  });
  ground.LayBox(Dirt, 14, 13, 22.5, 22);
  ground.TyreTracks(3, 0.72);
  ground.Stains(30, 0.3, 1.4, 0.64);
  ground.Specks(90, 0.1, 0.35, {{54, 88, 66}, {62, 100, 80}, {52, 60, 66}, {170, 176, 180}});
  return ground;
}

Ground Site() {
  Ground ground = Bare(Dirt, 20);
  ground.LayBox(Gravel, 0, 9, kSide, 14.5);
  ground.TyreTracks(9, 0.7);
  ground.Stains(22, 0.4, 1.8, 0.62);
  ground.Draw([&](Pencil& pencil) {  // foundations
    pencil.Frame(17.5, 4.4, 9, 6, {150, 156, 160}, 0.5);
    pencil.Line({17.5, 1.4}, {17.5, 7.4}, {150, 156, 160}, 0.4);
    for (double x = 2; x < 8; x += 0.5) pencil.Line({x, 17}, {x, 22}, {84, 116, 150}, 0.22);  // planks
    pencil.Frame(5, 19.5, 6.6, 5.4, {62, 74, 84}, 0.1);
  });
  ground.Specks(200, 0.1, 0.4, {{120, 132, 140}, {150, 160, 166}, {58, 90, 70}, {62, 80, 140}, {70, 72, 74}});
  return ground;
}

Ground Park() {
  Ground ground = Bare(Grass, 21);
  ground.Stains(30, 0.4, 1.6, 0.75);
  ground.Lay(Gravel, {{10.6, -1}, {13.2, -1}, {13.6, 8}, {25, 15.6}, {25, 18.4}, {12.4, 11}, {10.9, 8}});
  ground.Lay(Gravel, {{10.9, 8}, {13.4, 9}, {11.4, 25}, {8.8, 25}});
  ground.LayDisc(Meadow, 4.6, 6.5, 3.2);
  ground.LayDisc(Dirt, 18.4, 5.4, 2.4);
  ground.Draw([&](Pencil& pencil) {
    pencil.Ring(18.4, 5.4, 2.4, {140, 146, 150}, 0.16);
    for (int i = 0; i < 90; ++i) {
      const double angle = i * 2.4, out = 2.1 * std::sqrt(i / 90.0);
      const Colour bloom = i % 3 == 0 ? Colour{70, 70, 190} : (i % 3 == 1 ? Colour{60, 180, 210} : Colour{70, 120, 60});
      pencil.Disc(18.4 + out * std::cos(angle), 5.4 + out * std::sin(angle), 0.13, bloom);
    }
  });
  ground.Specks(260, 0.05, 0.2, {{70, 190, 205}, {205, 215, 215}, {40, 84, 60}, {58, 96, 118}});
  return ground;
}

Ground Sports() {
  Ground ground = Bare(Grass, 22);
  const auto hard = [](float x, float y, float period) {
    return Bgr(Mix(Asphalt(x, y, period), Rgb(62, 104, 84), 0.6F));
  };
  const auto inner = [](float x, float y, float period) {
    return Bgr(Mix(Asphalt(x, y, period), Rgb(146, 76, 58), 0.6F));
  };
  ground.LayBox(hard, 3, 1, 21, 23);
  ground.LayBox(inner, 5, 2.5, 19, 21.5);
  ground.Stains(20, 0.3, 1.2, 0.78);
  ground.Cracks(5, 4, {50, 52, 54});
  ground.Paint(kLineWhite, [&](Pencil& pencil, const Colour& ink) {
    pencil.Frame(12, 12, 14, 19, ink, 0.1);
    pencil.Line({5, 12}, {19, 12}, ink, 0.1);
    pencil.Ring(12, 12, 1.8, ink, 0.1);
    for (const double way : {-1.0, 1.0}) {
      pencil.Frame(12, 12 + way * 6.6, 4.9, 5.8, ink, 0.1);
      pencil.Ring(12, 12 + way * 3.7, 1.8, ink, 0.1);
      pencil.Frame(12, 12 + way * 9.1, 11, 0.8, ink, 0.08);
    }
  });
  ground.Paint(kLineYellow, [&](Pencil& pencil, const Colour& ink) { pencil.Frame(12, 12, 9, 18, ink, 0.08); });
  ground.Draw([&](Pencil& pencil) { pencil.Frame(12, 12, 18, 22, {110, 112, 114}, 0.12); });
  ground.Specks(140, 0.05, 0.18, {{70, 190, 205}, {205, 215, 215}, {58, 96, 118}});
  return ground;
}

}  // namespace

const std::vector<TileEntry>& Tiles() {
  static const std::vector<TileEntry> kTiles = {
      {"road_straight", RoadStraight},
      {"road_bus", RoadBus},
      {"road_crossing", RoadCrossing},
      {"road_junction", [] { return Junction(14, true); }},
      {"road_tee", [] { return Junction(23, false); }},
      {"parking", Parking},
      {"helipad", Helipad},
      {"apron", Apron},
      {"court", Court},
      {"yard", Yard},
      {"site", Site},
      {"park", Park},
      {"sports", Sports},
  };
  return kTiles;
}

}  // namespace victorious::assets
