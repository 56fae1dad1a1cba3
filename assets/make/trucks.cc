// Large road vehicles: fire engine, tanker, ambulance, bus, container truck.
#include <cmath>
#include <string>
#include <utility>

#include "assets/make/catalogue.h"
#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

/// A cab over its engine, from `front` back over `length`.
struct CabShape {
  float front = 4;
  float length = 2;
  float half_width = 1.22F;
  float foot = 0.6F;
  float top = 2.8F;
  float rake = 0.25F;  ///< how far the roof's edge lies behind the bumper
};

Mesh CabMesh(const CabShape& cab) {
  const float rear = cab.front - cab.length;
  const float belt = std::lerp(cab.foot, cab.top, 0.48F);
  const Polygon side = Rounded(
      {{cab.front, cab.foot}, {cab.front, belt}, {cab.front - cab.rake, cab.top}, {rear, cab.top}, {rear, cab.foot}},
      0.14F, 3);
  return Tapered(Extrude(side, Axis::kX, -cab.half_width, cab.half_width, 0.07F), belt, 0.04F);
}

void DecorateCab(const Canvas& canvas, const CabShape& cab, int doors) {
  const double belt = std::lerp(cab.foot, cab.top, 0.5F), head = cab.top - 0.28;
  DrawOnBothSides(canvas, "cab", [&](Stencil& colour, Stencil& shade) {
    const double step = (cab.length - 0.35) / doors;
    for (int i = 0; i < doors; ++i) {
      const double front = cab.front - 0.28 - i * step, rear = front - step + 0.12;
      DrawWindow(colour, {{rear + 0.06, belt},
                          {front - 0.02, belt},
                          {front - (i == 0 ? cab.rake * 0.8 : 0.06), head},
                          {rear + 0.06, head}});
      DrawDoor(colour, shade, rear, cab.foot + 0.15, front, head + 0.1);
    }
  });
  Stencil screen = canvas.Colour("cab", Side::kFront);
  const double wide = cab.half_width - 0.14;
  DrawWindow(screen, {{-wide, belt}, {wide, belt}, {wide - 0.06, head}, {-wide + 0.06, head}});
  screen.Line(-0.7, belt, 0.1, belt + 0.4, kBlack, 0.04);
  screen.Line(0.1, belt, 0.9, belt + 0.4, kBlack, 0.04);
  DrawHeadlamps(screen, cab.half_width - 0.3, cab.foot + 0.3, 0.13);
  Stencil grille = canvas.Shade("cab", Side::kFront);
  grille.Grille(-0.6, cab.foot + 0.2, 0.6, belt - 0.25, 6);
  Stencil roof = canvas.Shade("cab", Side::kTop);
  roof.Frame(cab.front - cab.length + 0.1, -wide, cab.front - cab.rake - 0.1, wide, kGroove, 0.025);
  roof.Panel(cab.front - cab.length * 0.75, -0.35, cab.front - cab.length * 0.4, 0.35);
}

Mesh Chassis(float front, float rear, float axle_y) {
  Mesh frame = Box({0, axle_y + 0.25F, (front + rear) / 2}, {0.9F, 0.28F, front - rear}, 0.03F);
  frame.AddBothSides(Box({0.95F, axle_y + 0.1F, (front + rear) / 2 + 0.4F}, {0.5F, 0.5F, 1.3F}, 0.08F));  // tanks
  frame.Add(Box({0, axle_y + 0.1F, rear + 0.05F}, {2.3F, 0.2F, 0.12F}, 0.03F));
  for (const float s : {-0.85F, 0.85F})
    frame.Add(Box({s, 0.35F, rear + 0.5F}, {0.5F, 0.5F, 0.02F}, 0.005F));  // mudflaps
  return frame;
}

Mesh LightBar(float z, float y, float half) {
  Mesh bar = Box({0, y + 0.07F, z}, {2 * half, 0.14F, 0.3F}, 0.04F);
  return bar;
}

Paint LightBarPaint(float half) {
  return [=](const Surface& s) {
    const float x = s.position.x() / half;
    if (std::abs(x) < 0.22F) return Rgb(210, 210, 204);
    return std::fmod(std::abs(x) * 9, 2.0F) < 0.25F ? Rgb(28, 32, 60) : Rgb(52, 92, 190);
  };
}

// --- Fire engine -----------------------------------------------------------------------------------------------------

const CabShape kFireCab{.front = 4.7F, .length = 2.9F, .half_width = 1.23F, .foot = 0.55F, .top = 2.75F, .rake = 0.3F};

Mesh FireLadder() {
  Mesh ladder;
  const Vec3 rear(0, 3.35F, -3.9F), front(0, 3.6F, 4.9F);
  for (const float shift : {0.0F, 0.14F}) {
    const Vec3 lift(0, shift, 0);
    ladder.Add(Ladder(rear + lift, front + lift - Vec3(0, 0, 2.5F * shift), 0.95F - shift, 0.4F, 0.04F));
  }
  for (const float x : {-0.5F, 0.5F}) {
    ladder.Add(Tube({{x, 3.75F, -3.7F}, {x, 3.98F, 4.4F}}, 0.03F, 5));
    for (int i = 0; i < 11; ++i) {
      const float z = -3.6F + 0.8F * static_cast<float>(i);
      ladder.Add(
          Cylinder({x, 3.36F + 0.0285F * (z + 3.9F), z}, {x, 3.75F + 0.0285F * (z + 3.9F), z + 0.4F}, 0.022F, 5));
    }
  }
  ladder.Add(Box({0, 3.65F, 5.0F}, {1.3F, 0.5F, 0.75F}, 0.04F));  // the basket
  ladder.Add(Cylinder({0, 2.95F, -3.6F}, {0, 3.3F, -3.6F}, 0.85F, 18))
      .Add(Box({0.75F, 3.5F, -3.4F}, {0.5F, 0.55F, 0.6F}, 0.05F));
  return ladder;
}

void DecorateFireEngine(const Canvas& canvas) {
  DecorateCab(canvas, kFireCab, 2);
  const Colour yellow{58, 200, 222};
  DrawOnBothSides(canvas, "cab", [&](Stencil& colour, Stencil&) {
    colour.Box(1.85, 1.12, 4.66, 1.4, yellow);
    colour.Text(3.2, 1.26, "RESCUE 7", 0.2, {40, 40, 120});
  });
  DrawOnBothSides(canvas, "body", [&](Stencil& colour, Stencil& shade) {
    for (int i = 0; i < 4; ++i) {
      const double z = 1.55 - 1.52 * i;
      const bool over_wheel = i == 2;
      colour.Box(z, over_wheel ? 1.65 : 0.85, z - 1.38, 2.55, {172, 176, 176});
      for (double y = over_wheel ? 1.7 : 0.9; y < 2.5; y += 0.1) colour.Line(z, y, z - 1.38, y, {136, 140, 142}, 0.025);
      shade.Frame(z, over_wheel ? 1.65 : 0.85, z - 1.38, 2.55, kGroove, 0.03);
    }
    colour.Box(1.8, 2.64, -4.7, 2.9, yellow);
    colour.Text(-1.4, 2.77, "FIRE SERVICE", 0.19, {40, 40, 120});
  });
  Stencil top = canvas.Colour("body", Side::kTop);
  for (double z = -4.4; z < 1.6; z += 0.3) {
    for (const double s : {-1.0, 1.0}) top.Line(z, s * 0.62, z + 0.12, s * 1.12, {134, 138, 140}, 0.03);
  }
  for (const double s : {-1.0, 1.0}) {
    top.Box(0.2, s * 0.66, 1.5, s * 1.08, {60, 74, 88});
    top.Box(-2.2, s * 0.66, -0.6, s * 1.08, {52, 110, 150});
    for (double z = -2.1; z < -0.6; z += 0.2) top.Line(z, s * 0.66, z, s * 1.08, {40, 84, 116}, 0.04);
  }
  top.Text(0.9, 0.0, "07", 0.7, kWhite);
  Stencil cab_roof = canvas.Colour("cab", Side::kTop);
  cab_roof.Text(2.35, 0.75, "07", 0.5, kWhite);
  cab_roof.Text(2.35, -0.75, "07", 0.5, kWhite);
  Stencil back = canvas.Colour("body", Side::kBack);
  back.Hazard(-1.2, 0.7, 1.2, 2.2, {40, 44, 180}, yellow, 0.25);
  DrawTailLamps(back, 1.05, 0.9, 0.16, 0.3);
}

// --- Tanker ----------------------------------------------------------------------------------------------------------

const CabShape kTankerCab{.front = 5.3F, .length = 2.1F, .half_width = 1.22F, .foot = 0.6F, .top = 2.9F, .rake = 0.2F};

Mesh TankerTank() {
  std::vector<Ring> rings;
  for (const auto& [z, size] : {std::pair{2.85F, 0.55F},
                                {2.75F, 0.85F},
                                {2.5F, 1.0F},
                                {0.45F, 1.0F},
                                {-1.6F, 1.0F},
                                {-3.6F, 1.0F},
                                {-5.3F, 1.0F},
                                {-5.52F, 0.85F},
                                {-5.6F, 0.55F}}) {
    rings.push_back(Section({z, 2.15F, 1.22F * size, 1.02F * size, 0.98F * size, 2.6F}, 26));
  }
  Mesh tank = Loft(rings);
  for (const float z : {2.5F, 0.45F, -1.6F, -3.6F, -5.25F}) {  // hoops
    tank.Add(Loft({Section({z - 0.05F, 2.15F, 1.25F, 1.05F, 1.0F, 2.6F}, 26),
                   Section({z + 0.05F, 2.15F, 1.25F, 1.05F, 1.0F, 2.6F}, 26)}));
  }
  return tank;
}

Mesh TankerFittings() {
  Mesh fittings = Chassis(5.0F, -5.6F, 0.6F);
  const Mesh lid =
      Revolve({{0, 0.0F}, {0, 0.34F}, {0.14F, 0.34F}, {0.16F, 0.24F}, {0.22F, 0.2F}, {0.24F, 0.0F}}, Axis::kY, 16);
  for (const float z : {1.5F, -0.6F, -2.6F, -4.4F}) fittings.Add(lid, At(0, 3.14F, z));
  fittings.AddBothSides(Box({0.62F, 3.14F, -1.4F}, {0.36F, 0.06F, 7.6F}, 0.01F));
  for (const float x : {-0.84F, 0.84F}) {
    fittings.Add(Tube({{x, 3.62F, 2.3F}, {x, 3.62F, -5.1F}}, 0.025F, 5));
    for (int i = 0; i < 7; ++i)
      fittings.Add(Cylinder({x, 3.05F, 2.2F - 1.2F * static_cast<float>(i)},
                            {x, 3.62F, 2.2F - 1.2F * static_cast<float>(i)}, 0.022F, 5));
  }
  fittings.Add(Ladder({0.5F, 0.9F, -5.72F}, {0.5F, 3.4F, -5.55F}, 0.45F));
  fittings.AddBothSides(Box({1.05F, 0.95F, -0.9F}, {0.45F, 0.5F, 2.6F}, 0.06F));  // hose boxes
  return fittings.AddBothSides(Box({1.0F, 1.18F, -3.6F}, {0.5F, 0.06F, 3.2F}, 0.02F));
}

void DecorateTanker(const Canvas& canvas) {
  DecorateCab(canvas, kTankerCab, 1);
  const Colour green{88, 118, 44}, orange{48, 128, 222};
  DrawOnBothSides(canvas, "tank", [&](Stencil& colour, Stencil& shade) {
    colour.Box(2.9, 1.75, -5.6, 2.25, green);
    colour.Box(2.9, 1.62, -5.6, 1.7, orange);
    colour.Text(-1.2, 2.6, "FUEL 3000", 0.42, green);
    colour.Box(-4.9, 2.45, -4.4, 2.85, orange);
    colour.Text(-4.65, 2.65, "33", 0.2, kBlack);
    shade.Rivets(2.4, 1.5, -5.3, 1.5, 0.25);
  });
  Stencil top = canvas.Colour("tank", Side::kTop);
  for (const double s : {-1.0, 1.0}) top.Box(-5.2, s * 0.98, 2.4, s * 1.1, green);
  top.Text(0.45, -0.0, "T4", 0.5, {44, 44, 44});
  Stencil stains = canvas.Shade("tank", Side::kTop);
  for (const double z : {1.5, -0.6, -2.6, -4.4}) {
    stains.Disc(z, 0, 0.55, Colour{92});
    stains.Line(z, 0, z + 0.1, 1.1, Colour{88}, 0.16);
    stains.Line(z, 0, z - 0.1, -1.0, Colour{96}, 0.12);
  }
  Stencil back = canvas.Colour("tank", Side::kBack);
  back.Hazard(-0.9, 1.4, 0.9, 1.7, {40, 44, 180}, {58, 200, 222}, 0.2);
  back.Box(-0.4, 2.1, 0.2, 2.5, orange);
}

// --- Ambulance -------------------------------------------------------------------------------------------------------

const CabShape kAmbulanceCab{
    .front = 2.45F, .length = 1.55F, .half_width = 0.98F, .foot = 0.45F, .top = 2.1F, .rake = 0.75F};

void DecorateAmbulance(const Canvas& canvas) {
  DecorateCab(canvas, kAmbulanceCab, 1);
  const Colour yellow{60, 206, 222}, green{84, 124, 40}, blue{130, 70, 36};
  const auto chequers = [&](Stencil& s, double a0, double a1, double b) {
    int cell = 0;
    for (double a = a0; a < a1 - 0.1; a += 0.4, ++cell) {
      s.Box(a, b, std::min(a + 0.4, a1), b + 0.26, cell % 2 == 0 ? yellow : green);
      s.Box(a, b + 0.26, std::min(a + 0.4, a1), b + 0.52, cell % 2 == 0 ? green : yellow);
    }
  };
  DrawOnBothSides(canvas, "box", [&](Stencil& colour, Stencil& shade) {
    chequers(colour, -3.2, 0.95, 0.95);
    colour.Text(-1.0, 2.2, "AMBULANCE", 0.3, blue);
    DrawWindow(colour, {{-0.9, 1.65}, {0.0, 1.65}, {0.0, 2.0}, {-0.9, 2.0}});
    shade.Frame(-0.1, 0.6, 0.85, 2.5, kGroove, 0.03);
    shade.Panel(-3.1, 1.6, -2.2, 2.05);
    shade.Grille(-2.0, 1.65, -1.3, 1.95, 5);
  });
  Stencil roof = canvas.Colour("box", Side::kTop);
  roof.Box(-3.2, -0.95, -2.9, 0.95, yellow);
  roof.Text(-2.2, 0.4, "AMB", 0.36, blue);
  roof.Text(-2.2, -0.4, "112", 0.42, green);
  for (double x = -0.9; x < 0.9; x += 0.36) {
    roof.Box(0.25, x, 0.5, x + 0.18, green);
    roof.Box(0.5, x + 0.18, 0.75, x + 0.36, green);
  }
  Stencil panels = canvas.Shade("box", Side::kTop);
  panels.Panel(-0.85, -0.45, -0.05, 0.45);
  for (const double z : {-2.5, -1.2, 0.1}) panels.Line(z, -1.05, z, 1.05, Colour{100}, 0.03);
  panels.Rivets(-3.1, 0.98, 0.8, 0.98, 0.2);
  panels.Rivets(-3.1, -0.98, 0.8, -0.98, 0.2);
  Stencil bonnet = canvas.Colour("cab", Side::kTop);
  const double wide = 0.82;
  DrawWindow(bonnet, {{2.2, -wide}, {2.2, wide}, {1.75, wide - 0.06}, {1.75, -wide + 0.06}});
  Stencil back = canvas.Colour("box", Side::kBack);
  back.Hazard(-1.0, 0.6, 1.0, 1.5, yellow, {40, 44, 180}, 0.2);
  DrawWindow(back, {{-0.85, 1.7}, {-0.1, 1.7}, {-0.1, 2.2}, {-0.85, 2.2}});
  DrawWindow(back, {{0.1, 1.7}, {0.85, 1.7}, {0.85, 2.2}, {0.1, 2.2}});
  DrawTailLamps(back, 0.98, 1.0, 0.12, 0.4);
}

// --- Bus -------------------------------------------------------------------------------------------------------------

Mesh BusBody() {
  const Polygon side =
      SideOutline(Rounded({{5.95F, 0.35F}, {6.0F, 1.3F}, {5.7F, 3.0F}, {-5.95F, 3.0F}, {-6.0F, 0.4F}}, 0.28F, 3), 0.32F,
                  {-2.9F, 3.3F}, 0.5F, 0.6F);
  return Extrude(side, Axis::kX, -1.27F, 1.27F, 0.12F);
}

void DecorateBus(const Canvas& canvas) {
  const Colour teal{120, 112, 38}, cream{196, 222, 228};
  DrawOnBothSides(canvas, "body", [&](Stencil& colour, Stencil& shade) {
    colour.Box(6.2, 0.95, -6.2, 1.25, cream);
    colour.Fill({{-3.2, 0.3}, {-6.1, 0.3}, {-6.1, 3.0}, {-4.6, 3.0}}, cream);
    for (int i = 0; i < 8; ++i) {
      const double z = 5.3 - 1.35 * i;
      DrawWindow(colour, {{z, 1.45}, {z - 1.25, 1.45}, {z - 1.25, 2.5}, {z, 2.5}});
    }
    shade.Rivets(5.8, 1.35, -5.8, 1.35, 0.24);
    shade.Grille(-4.6, 0.5, -5.6, 0.85, 6);
    colour.Text(0.2, 0.72, "CITY LINE", 0.32, cream);
  });
  Stencil door = canvas.Colour("body", Side::kRight);
  for (const double z : {4.6, 0.3}) {
    door.Box(z - 0.65, 0.42, z + 0.65, 2.5, {44, 42, 40});
    door.Box(z - 0.58, 0.55, z - 0.04, 2.4, {98, 86, 76});
    door.Box(z + 0.04, 0.55, z + 0.58, 2.4, {98, 86, 76});
  }
  Stencil roof = canvas.Colour("body", Side::kTop);
  roof.Fill({{-6.1, -1.3}, {-4.6, -1.3}, {-4.0, 1.3}, {-6.1, 1.3}}, cream);
  roof.Text(3.6, 0.0, "118", 1.1, teal);
  roof.Box(5.2, -1.0, 5.4, 1.0, teal);
  Stencil seams = canvas.Shade("body", Side::kTop);
  for (double z = -5.4; z < 5.6; z += 1.2) seams.Line(z, -1.2, z, 1.2, Colour{96}, 0.03);
  for (const double x : {-0.95, 0.95}) seams.Line(-5.8, x, 5.6, x, Colour{104}, 0.05);
  seams.Panel(-1.9, -0.5, -0.9, 0.5);
  seams.Panel(1.4, -0.5, 2.4, 0.5);
  Stencil front = canvas.Colour("body", Side::kFront);
  DrawWindow(front, {{-1.1, 1.3}, {1.1, 1.3}, {1.05, 2.5}, {-1.05, 2.5}});
  front.Box(-0.85, 2.6, 0.85, 2.85, {30, 30, 30});
  front.Text(0, 2.72, "118", 0.16, {60, 180, 230});
  DrawHeadlamps(front, 0.9, 0.7, 0.13);
  Stencil back = canvas.Colour("body", Side::kBack);
  DrawTailLamps(back, 1.0, 0.9, 0.18, 0.5);
  DrawWindow(back, {{-0.9, 1.7}, {0.9, 1.7}, {0.9, 2.5}, {-0.9, 2.5}});
}

// --- Container truck -------------------------------------------------------------------------------------------------

const CabShape kHaulerCab{.front = 5.9F, .length = 2.2F, .half_width = 1.24F, .foot = 0.6F, .top = 3.2F, .rake = 0.2F};

Paint Corrugated(const Bgr& colour, std::uint32_t seed) {
  return [=](const Surface& s) {
    const float along = std::abs(s.normal.z()) > 0.6F ? s.position.x() : s.position.z();
    const float rib = std::fmod(along + 20, 0.3F);
    const float rust = Ramp(Fractal(s.position * 0.9F, seed, 4), 0.2F, 0.45F);
    return Mix(Bgr(colour * (rib < 0.1F ? 0.72F : (rib < 0.16F ? 1.14F : 1.0F))), Rgb(110, 68, 46), 0.6F * rust);
  };
}

void DecorateHauler(const Canvas& canvas) {
  DecorateCab(canvas, kHaulerCab, 1);
  DrawOnBothSides(canvas, "front_box", [](Stencil& colour, Stencil&) {
    colour.Text(0.2, 2.7, "SEABOX 4", 0.55, kWhite);
    colour.Box(-2.5, 1.7, 2.7, 1.85, kWhite);
  });
  DrawOnBothSides(canvas, "rear_box",
                  [](Stencil& colour, Stencil&) { colour.Text(-4.6, 2.7, "TR 9", 0.6, {60, 52, 46}); });
  Stencil first = canvas.Colour("front_box", Side::kTop);
  first.Text(0.4, 0.0, "SB 20", 0.9, kWhite);
  first.Box(-2.5, -1.15, -2.2, 1.15, {60, 190, 215});
  Stencil second = canvas.Colour("rear_box", Side::kTop);
  second.Text(-4.6, 0.3, "TR 9", 0.8, {60, 52, 46});
  second.Box(-5.2, -1.1, -4.1, -0.5, {66, 72, 190});
  Stencil doors = canvas.Shade("rear_box", Side::kBack);
  for (const double x : {-0.85, -0.3, 0.3, 0.85}) doors.Line(x, 1.35, x, 3.8, kRidge, 0.06);
  Stencil cab = canvas.Colour("cab", Side::kTop);
  cab.Box(3.9, -0.9, 4.15, 0.9, kWhite);
}

}  // namespace

Asset FireEngine() {
  Asset asset{.name = "fire_engine", .length_m = 9.8F};
  const Bgr red = Rgb(166, 34, 30);
  asset.Add("cab", CabMesh(kFireCab), Coat(red));
  asset.Add("body", Box({0, 1.85F, -1.45F}, {2.48F, 2.2F, 6.5F}, 0.06F), [red](const Surface& s) {
    const Bgr tread = Rgb(128, 132, 134) * (0.92F + 0.12F * Noise(s.position * 6, 8));
    return s.normal.y() > 0.8F ? tread : Bgr(red * (1 + 0.06F * Fractal(s.position, 9, 3)));
  });
  asset.Add("chassis", Chassis(4.6F, -4.7F, 0.55F), Coat(kDarkMetal)).density = 0.3F;
  asset.Add("ladder", FireLadder(), Metal(Rgb(186, 190, 190))).density = 0.6F;
  asset.Add("lights", LightBar(4.0F, 2.74F, 1.05F), LightBarPaint(1.05F));
  asset.Add("mirrors", Mirrors(1.2F, 1.9F, 4.6F, 0.4F), Coat(Rgb(44, 44, 46))).density = 0.3F;
  Mesh reels = Cylinder({-1.0F, 3.12F, 0.9F}, {-0.6F, 3.12F, 0.9F}, 0.26F, 14);
  reels.Add(Cylinder({0.62F, 3.05F, -1.6F}, {0.62F, 3.05F, 1.4F}, 0.12F, 8))
      .Add(Box({-0.85F, 3.05F, -0.9F}, {0.5F, 0.22F, 1.6F}, 0.04F));
  asset.Add("reels", std::move(reels), Coat(Rgb(196, 176, 120), 0.12F)).density = 0.5F;
  AddWheels(
      asset,
      {.radius = 0.53F, .width = 0.32F, .x = 1.05F, .z = {3.4F, -2.4F}, .rim = kSteel, .bolts = 8, .rear_twins = 1});
  asset.decorate = DecorateFireEngine;
  asset.weather = {.dust_height_m = 0.35F, .streaks = 0.10F, .stains = 0.07F, .seed = 15};
  return asset;
}

Asset Tanker() {
  Asset asset{.name = "tanker", .length_m = 11};
  asset.Add("cab", CabMesh(kTankerCab), Coat(Rgb(46, 112, 92)));
  asset.Add("tank", TankerTank(), Metal(Rgb(196, 198, 194), 6));
  asset.Add("fittings", TankerFittings(), Metal(Rgb(104, 108, 110))).density = 0.6F;
  asset.Add("mirrors", Mirrors(1.2F, 2.0F, 5.2F, 0.4F), Coat(Rgb(44, 44, 46))).density = 0.3F;
  AddWheels(asset, {.radius = 0.54F,
                    .width = 0.32F,
                    .x = 1.05F,
                    .z = {4.2F, -2.9F, -4.2F},
                    .rim = kSteel,
                    .bolts = 8,
                    .rear_twins = 2});
  asset.decorate = DecorateTanker;
  asset.weather = {.dust_height_m = 0.45F, .streaks = 0.2F, .stains = 0.1F, .seed = 16};
  return asset;
}

Asset Ambulance() {
  Asset asset{.name = "ambulance", .length_m = 6.2F};
  Mesh cab = CabMesh(kAmbulanceCab);
  cab.Add(Box({0, 0.85F, 2.6F}, {1.8F, 0.7F, 0.7F}, 0.14F));
  asset.Add("cab", std::move(cab), Coat(Rgb(222, 222, 216), 0.03F));
  asset.Add("box", Box({0, 1.55F, -1.15F}, {2.15F, 2.0F, 4.2F}, 0.09F), Coat(Rgb(222, 222, 216), 0.03F));
  asset.Add("chassis", Chassis(2.6F, -3.2F, 0.38F), Coat(kDarkMetal)).density = 0.3F;
  asset.Add("lights", LightBar(0.65F, 2.54F, 0.85F).Add(LightBar(-2.95F, 2.54F, 0.85F)), LightBarPaint(0.85F));
  asset.Add("unit", Box({0.1F, 2.62F, -1.25F}, {0.9F, 0.18F, 0.7F}, 0.05F), Coat(Rgb(180, 182, 180))).density = 0.8F;
  asset.Add("mirrors", Mirrors(0.95F, 1.4F, 2.0F, 0.3F), Coat(Rgb(44, 44, 46))).density = 0.3F;
  AddWheels(asset, {.radius = 0.37F, .width = 0.24F, .x = 0.92F, .z = {1.95F, -2.0F}, .rim = kSteel, .bolts = 6});
  asset.decorate = DecorateAmbulance;
  asset.weather = {.dust_height_m = 0.25F, .streaks = 0.09F, .stains = 0.07F, .seed = 17};
  return asset;
}

Asset Bus() {
  Asset asset{.name = "bus", .length_m = 12};
  asset.Add("body", BusBody(), [](const Surface& s) {
    const Bgr side = Rgb(38, 112, 120), roof = Rgb(206, 206, 196);
    return Bgr((s.normal.y() > 0.6F && s.position.y() > 2.5F ? roof : side) * (1 + 0.05F * Fractal(s.position, 3, 3)));
  });
  Mesh units = Box({0, 3.12F, -3.0F}, {1.9F, 0.3F, 2.3F}, 0.1F);
  units.Add(Box({0, 3.07F, 0.3F}, {0.8F, 0.2F, 0.8F}, 0.06F))
      .Add(Box({0.5F, 3.06F, -0.4F}, {0.2F, 0.16F, 0.2F}, 0.03F));
  asset.Add("units", std::move(units), [](const Surface& s) {
    const bool slot =
        s.normal.y() > 0.7F && std::fmod(s.position.z() + 20, 0.24F) < 0.08F && std::abs(s.position.x()) < 0.7F;
    return Bgr(Rgb(150, 154, 154) * (slot ? 0.5F : 1.0F));
  });
  asset.Add("mirrors", Mirrors(1.25F, 2.3F, 5.9F, 0.4F), Coat(Rgb(44, 44, 46))).density = 0.3F;
  AddWheels(
      asset,
      {.radius = 0.5F, .width = 0.3F, .x = 1.08F, .z = {3.3F, -2.9F}, .rim = kSteel, .bolts = 8, .rear_twins = 1});
  asset.decorate = DecorateBus;
  asset.weather = {.dust_height_m = 0.35F, .streaks = 0.12F, .stains = 0.1F, .seed = 18};
  return asset;
}

Asset ContainerTruck() {
  Asset asset{.name = "container_truck", .length_m = 13};
  Mesh cab = CabMesh(kHaulerCab);
  cab.Add(Extrude({{4.9F, 3.15F}, {4.0F, 3.75F}, {3.75F, 3.75F}, {3.75F, 3.15F}}, Axis::kX, -1.0F, 1.0F,
                  0.06F));  // wind deflector
  asset.Add("cab", std::move(cab), Coat(Rgb(192, 138, 44)));
  asset.Add("front_box", Box({0, 2.6F, 0.05F}, {2.44F, 2.55F, 5.9F}, 0.04F), Corrugated(Rgb(52, 82, 122), 91));
  asset.Add("rear_box", Box({0, 2.6F, -4.6F}, {2.44F, 2.55F, 2.95F}, 0.04F), Corrugated(Rgb(172, 168, 158), 95));
  Mesh chassis = Chassis(5.6F, -6.3F, 0.6F);
  chassis.Add(Box({0, 1.22F, -1.5F}, {2.4F, 0.2F, 9.4F}, 0.03F))
      .AddBothSides(Cylinder({0.9F, 1.2F, 3.45F}, {0.9F, 3.3F, 3.45F}, 0.09F, 8));
  asset.Add("chassis", std::move(chassis), Coat(kDarkMetal, 0.12F)).density = 0.35F;
  asset.Add("mirrors", Mirrors(1.22F, 2.2F, 5.8F, 0.45F), Coat(Rgb(44, 44, 46))).density = 0.3F;
  AddWheels(asset, {.radius = 0.53F,
                    .width = 0.32F,
                    .x = 1.06F,
                    .z = {4.9F, 2.2F, -3.3F, -4.5F, -5.7F},
                    .rim = kSteel,
                    .bolts = 8,
                    .rear_twins = 3});
  asset.decorate = DecorateHauler;
  asset.weather = {.dust_height_m = 0.45F, .streaks = 0.18F, .stains = 0.12F, .seed = 19};
  return asset;
}

}  // namespace victorious::assets
