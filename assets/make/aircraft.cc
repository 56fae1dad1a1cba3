// Military aircraft: an attack helicopter and a jet fighter.
#include <cmath>

#include "assets/make/catalogue.h"
#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

Mesh Skin(const std::vector<SectionShape>& shapes, int points) {
  std::vector<Ring> rings;
  for (const SectionShape& shape : shapes) rings.push_back(Section(shape, points));
  return Loft(rings);
}

/// The maker's own national mark: a lozenge with a disc.
void DrawMark(Stencil& stencil, double a, double b, double size) {
  const auto lozenge = [&](double s, const Colour& colour) {
    stencil.Fill({{a - s, b}, {a, b + s * 0.7}, {a + s, b}, {a, b - s * 0.7}}, colour);
  };
  lozenge(size, kWhite);
  lozenge(size * 0.84, {120, 62, 36});
  stencil.Disc(a, b, size * 0.3, kWhite);
}

// --- Helicopter ------------------------------------------------------------------------------------------------------

Paint HelicopterCamouflage() {
  return Camouflage(Rgb(84, 88, 66), {{Rgb(58, 63, 48), 0.42F}, {Rgb(108, 98, 74), 0.24F}, {Rgb(46, 47, 42), 0.12F}},
                    1.0F, 77);
}

Mesh HelicopterFuselage() {
  Mesh hull = Skin({{5.6F, 1.55F, 0.16F, 0.14F, 0.14F, 2.5F},
                    {5.3F, 1.58F, 0.38F, 0.3F, 0.32F, 3},
                    {4.5F, 1.65F, 0.55F, 0.5F, 0.5F, 3},
                    {3.2F, 1.75F, 0.64F, 0.6F, 0.65F, 3.5F},
                    {1.6F, 1.85F, 0.72F, 0.75F, 0.75F, 4},
                    {-0.6F, 1.9F, 0.76F, 0.8F, 0.76F, 4},
                    {-2.2F, 2.02F, 0.62F, 0.66F, 0.62F, 4},
                    {-3.6F, 2.12F, 0.42F, 0.48F, 0.44F, 3},
                    {-6.0F, 2.2F, 0.3F, 0.34F, 0.32F, 3},
                    {-8.6F, 2.25F, 0.2F, 0.26F, 0.24F, 3}},
                   20);
  const std::vector<SectionShape> nacelle = {{1.15F, 2.62F, 0.24F, 0.24F, 0.24F, 3, 0.78F},
                                             {0.8F, 2.62F, 0.37F, 0.36F, 0.36F, 3, 0.8F},
                                             {-0.9F, 2.64F, 0.38F, 0.36F, 0.36F, 3, 0.8F},
                                             {-1.7F, 2.66F, 0.32F, 0.3F, 0.3F, 3, 0.84F},
                                             {-2.25F, 2.7F, 0.26F, 0.24F, 0.24F, 2, 1.0F}};
  hull.AddBothSides(Skin(nacelle, 14));
  hull.Add(Skin({{1.2F, 2.7F, 0.3F, 0.35F, 0.3F, 3},
                 {0.7F, 2.75F, 0.42F, 0.55F, 0.4F, 3},
                 {-1.0F, 2.75F, 0.4F, 0.5F, 0.4F, 3},
                 {-2.6F, 2.5F, 0.16F, 0.25F, 0.2F, 2}},
                14));
  const std::vector<SectionShape> cheek = {{4.3F, 1.35F, 0.1F, 0.12F, 0.12F, 3, 0.6F},
                                           {3.6F, 1.35F, 0.24F, 0.28F, 0.26F, 4, 0.68F},
                                           {0.4F, 1.4F, 0.26F, 0.3F, 0.28F, 4, 0.78F},
                                           {-0.6F, 1.45F, 0.1F, 0.14F, 0.12F, 3, 0.74F}};
  return hull.AddBothSides(Skin(cheek, 12));
}

Mesh HelicopterCanopy() {
  const Polygon side = {{4.75F, 1.95F}, {4.1F, 2.56F}, {3.05F, 2.62F}, {2.7F, 3.02F},
                        {1.4F, 3.06F},  {0.95F, 2.6F}, {1.2F, 1.9F}};
  return Tapered(Extrude(side, Axis::kX, -0.6F, 0.6F, 0.06F), 2.0F, 0.3F);
}

Mesh HelicopterWings() {
  Mesh wing = Wing({{{0.6F, 1.95F, 0.75F}, 1.35F, 0.2F}, {{2.55F, 1.85F, 0.45F}, 1.0F, 0.12F}});
  wing.Add(Box({2.58F, 1.84F, -0.05F}, {0.12F, 0.16F, 1.2F}, 0.03F));
  for (const float x : {1.45F, 2.15F}) wing.Add(Box({x, 1.72F, 0.0F}, {0.1F, 0.3F, 0.8F}, 0.03F));
  Mesh wings = Mesh().AddBothSides(wing);
  wings.AddBothSides(Wing({{{0.1F, 2.25F, -6.9F}, 1.0F, 0.1F}, {{1.75F, 2.27F, -7.15F}, 0.7F, 0.05F}}));
  return wings.Add(
      Wing({{{0, 2.1F, -6.9F}, 1.8F, 0.24F}, {{0, 3.1F, -7.7F}, 1.3F, 0.18F}, {{0, 4.1F, -8.45F}, 0.85F, 0.1F}},
           Vec3::UnitX()));
}

Mesh HelicopterStores() {
  const Mesh pod = Revolve(
      {{-0.95F, 0.0F}, {-0.95F, 0.16F}, {-0.7F, 0.25F}, {0.85F, 0.25F}, {0.95F, 0.22F}, {0.95F, 0.0F}}, Axis::kZ, 14);
  Mesh missile = Revolve({{-0.8F, 0.0F}, {-0.8F, 0.08F}, {0.6F, 0.085F}, {0.74F, 0.06F}, {0.8F, 0.0F}}, Axis::kZ, 8);
  missile.Add(Box({0, 0, -0.65F}, {0.3F, 0.012F, 0.22F}, 0.003F))
      .Add(Box({0, 0, -0.65F}, {0.012F, 0.3F, 0.22F}, 0.003F));
  Mesh stores = Moved(pod, At(1.45F, 1.36F, 0.05F));
  for (const float x : {2.02F, 2.28F}) {
    for (const float y : {1.5F, 1.26F}) stores.Add(missile, At(x, y, 0.1F));
  }
  return Mesh().AddBothSides(stores);
}

Mesh HelicopterGear() {
  Mesh gear = Tube({{0.62F, 1.3F, 2.3F}, {1.05F, 0.42F, 1.75F}}, 0.07F, 8);
  gear.Add(Tube({{0.6F, 1.5F, 1.5F}, {1.05F, 0.46F, 1.75F}}, 0.045F, 6));
  gear = Mesh().AddBothSides(gear);
  gear.Add(Tube({{0, 2.1F, -7.0F}, {0, 0.4F, -7.9F}}, 0.08F, 8));
  gear.Add(Ball({0, 1.12F, 3.85F}, {0.26F, 0.22F, 0.3F}, 12));  // the gun below the nose
  gear.Add(Cylinder({0, 1.0F, 3.95F}, {0, 0.93F, 5.35F}, 0.045F, 8))
      .Add(Box({0, 1.02F, 4.1F}, {0.2F, 0.18F, 0.6F}, 0.03F));
  gear.Add(Ball({0, 1.6F, 5.55F}, {0.3F, 0.27F, 0.27F}, 14)).Add(Cylinder({0, 1.28F, 5.5F}, {0, 1.5F, 5.5F}, 0.2F, 12));
  gear.Add(Cylinder({0, 3.1F, -0.15F}, {0, 3.85F, -0.15F}, 0.16F, 12));  // mast
  gear.Add(
      Moved(Revolve({{0, 0.0F}, {0, 0.42F}, {0.12F, 0.5F}, {0.2F, 0.42F}, {0.32F, 0.15F}, {0.34F, 0.0F}}, Axis::kY, 16),
            At(0, 3.62F, -0.15F)));
  for (int i = 0; i < 4; ++i) {
    gear.Add(Moved(Box({0.55F, 3.74F, 0}, {0.7F, 0.1F, 0.16F}, 0.02F),
                   At(0, 0, -0.15F) * Turn(Axis::kY, 45 + 90.0F * static_cast<float>(i))));
    gear.Add(Cylinder({0.1F, 3.2F, -0.15F}, {0.12F, 3.65F, -0.05F}, 0.025F, 5));
  }
  gear.Add(Cylinder({0.05F, 3.75F, -8.5F}, {0.42F, 3.75F, -8.5F}, 0.09F, 10));
  for (const float z : {-3.2F, -5.0F}) gear.Add(Box({0, 2.8F, z}, {0.02F, 0.22F, 0.3F}, 0.004F));
  return gear;
}

Mesh RotorBlade(float root, float tip, float chord, float thickness, float droop) {
  std::vector<Ring> rings;
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = static_cast<float>(i) / kSteps;
    const float width = t < 0.12F ? chord * 0.5F : (t > 0.97F ? chord * 0.6F : chord);
    const float y = -droop * t * t;
    const float x = root + (tip - root) * t;
    rings.push_back({{x, y, width / 2},
                     {x, y + thickness / 2, width * 0.2F},
                     {x, y + thickness * 0.2F, -width / 2},
                     {x, y - thickness * 0.2F, -width / 2},
                     {x, y - thickness / 2, width * 0.2F}});
  }
  return Loft(rings);
}

void DecorateHelicopterSides(const Canvas& canvas) {
  DrawOnBothSides(canvas, "fuselage", [](Stencil& colour, Stencil& shade) {
    for (const double z : {4.4, 3.2, 1.75, 0.7, -0.5, -1.6, -2.9, -4.1, -5.3, -6.5, -7.6})
      shade.Line(z, 0.9, z, 3.2, kGroove, 0.025);
    shade.Line(5.2, 1.62, -2.2, 1.72, kGroove, 0.025);
    shade.Line(-2.2, 2.05, -8.4, 2.2, kGroove, 0.025);
    shade.Rivets(-2.9, 2.2, -8.2, 2.32, 0.16);
    shade.Rivets(1.7, 1.9, -2.4, 1.95, 0.14);
    shade.Panel(0.6, 1.78, -0.4, 2.2);
    shade.Panel(-0.6, 1.78, -1.5, 2.2);
    shade.Panel(3.4, 1.2, 2.4, 1.55);
    shade.Panel(2.2, 1.2, 1.3, 1.55);
    shade.Panel(1.1, 1.2, 0.2, 1.55);
    shade.Grille(0.5, 2.5, -0.5, 2.8, 6);
    shade.Disc(-2.4, 2.75, 0.35, kSoot);
    colour.Text(-4.75, 2.2, "HV 508", 0.3, kWhite);
    DrawMark(colour, -3.35, 2.2, 0.34);
    colour.Fill({{-2.55, 1.75}, {-2.4, 2.1}, {-2.3, 2.1}, {-2.45, 1.72}}, {48, 190, 220});
    colour.Hazard(-7.15, 2.02, -7.65, 2.42, {60, 190, 215}, {40, 40, 40}, 0.12);
  });
  DrawOnBothSides(canvas, "wings", [](Stencil& colour, Stencil& shade) {
    shade.Line(-8.0, 2.6, -9.0, 4.0, kGroove, 0.025);
    shade.Line(-7.9, 3.25, -9.2, 3.25, kGroove, 0.025);
    colour.Text(-8.35, 2.95, "08", 0.36, kWhite);
    colour.Box(-8.1, 3.75, -9.6, 3.92, {46, 52, 168});
  });
  DrawOnBothSides(canvas, "canopy", [](Stencil& colour, Stencil&) {
    const Colour frame = Pigment(Rgb(62, 66, 50));
    colour.Path({{4.75, 1.98}, {4.1, 2.56}, {3.05, 2.62}, {2.7, 3.02}, {1.4, 3.06}, {0.95, 2.6}, {1.2, 1.95}}, frame,
                0.12);
    for (const double z : {4.05, 3.02, 2.66, 1.55}) colour.Line(z, 1.9, z - 0.05, 3.1, frame, 0.09);
    colour.Line(4.8, 2.02, 1.0, 2.02, frame, 0.12);
    colour.Fill({{3.9, 2.5}, {3.5, 2.52}, {3.2, 2.1}, {3.6, 2.1}}, {128, 116, 100});
    colour.Fill({{2.5, 2.96}, {2.1, 2.96}, {1.85, 2.1}, {2.3, 2.1}}, {128, 116, 100});
  });
}

void DecorateHelicopter(const Canvas& canvas) {
  DecorateHelicopterSides(canvas);
  Stencil top = canvas.Shade("fuselage", Side::kTop);
  for (const double z : {4.4, 3.2, 0.7, -0.5, -1.6, -2.9, -4.1, -5.3, -6.5, -7.6})
    top.Line(z, -1.3, z, 1.3, kGroove, 0.025);
  top.Line(-2.2, 0.16, -8.4, 0.08, kGroove, 0.02);
  top.Line(-2.2, -0.16, -8.4, -0.08, kGroove, 0.02);
  for (const double x : {-0.8, 0.8}) {
    top.Panel(-0.3, x - 0.24, 0.55, x + 0.24);
    top.Grille(-1.4, x - 0.22, -0.7, x + 0.22, 6, false);
    top.Disc(-2.2, x * 1.2, 0.36, kSoot);
    top.Disc(1.1, x, 0.22, kSoot);
  }
  top.Panel(-1.4, -0.24, -0.6, 0.24);
  Stencil wings = canvas.Shade("wings", Side::kTop);
  for (const double x : {-1.0, 1.0}) {
    for (const double at : {0.95, 1.45, 2.15}) wings.Line(0.8, x * at, -0.7, x * at, kGroove, 0.025);
    wings.Line(-0.25, x * 0.7, -0.3, x * 2.5, kGroove, 0.03);
    wings.Rivets(0.3, x * 0.8, 0.15, x * 2.4, 0.14);
    wings.Line(-7.5, x * 0.2, -7.5, x * 1.7, kGroove, 0.025);
  }
  Stencil marks = canvas.Colour("wings", Side::kTop);
  DrawMark(marks, 0.12, 1.78, 0.36);
  DrawMark(marks, 0.12, -1.78, 0.36);
  for (const double x : {-1.0, 1.0}) marks.Frame(0.3, x * 0.85, -0.2, x * 1.35, Colour{36, 42, 150}, 0.04);
  Stencil glass = canvas.Colour("canopy", Side::kTop);
  const Colour frame = Pigment(Rgb(62, 66, 50));
  for (const double z : {4.72, 4.05, 3.02, 2.68, 1.42, 1.0}) glass.Line(z, -0.7, z, 0.7, frame, 0.11);
  for (const double x : {-0.42, 0.0, 0.42}) glass.Line(0.9, x, 4.8, x, frame, x == 0.0 ? 0.05 : 0.1);
  Stencil pods = canvas.Colour("stores", Side::kFront);
  for (const double x : {-1.45, 1.45}) {
    for (int i = 0; i < 7; ++i) {
      const double angle = i * 1.0472, out = i == 6 ? 0.0 : 0.14;
      pods.Disc(x + out * std::cos(angle), 1.36 + out * std::sin(angle), 0.045, {24, 24, 24});
    }
  }
}

// --- Jet -------------------------------------------------------------------------------------------------------------

Paint JetCamouflage() {
  return Camouflage(Rgb(160, 168, 172),
                    {{Rgb(104, 118, 130), 0.40F}, {Rgb(128, 142, 150), 0.22F}, {Rgb(74, 86, 98), 0.14F}}, 1.5F, 131);
}

Mesh JetFuselage() {
  Mesh hull = Skin({{8.3F, 1.84F, 0.02F, 0.02F, 0.02F},
                    {7.6F, 1.87F, 0.2F, 0.2F, 0.2F},
                    {6.4F, 1.92F, 0.42F, 0.42F, 0.42F},
                    {5.0F, 1.98F, 0.56F, 0.55F, 0.55F},
                    {3.4F, 2.04F, 0.66F, 0.6F, 0.6F, 2.4F},
                    {1.8F, 2.08F, 0.85F, 0.62F, 0.62F, 3},
                    {-0.5F, 2.08F, 1.2F, 0.62F, 0.6F, 3},
                    {-3.5F, 2.06F, 1.34F, 0.52F, 0.56F, 3.5F},
                    {-6.0F, 2.05F, 1.26F, 0.46F, 0.5F, 3.5F},
                    {-7.2F, 2.05F, 1.16F, 0.36F, 0.4F, 3.5F}},
                   24);
  const auto intake = [](float z, float reach) {
    return SectionShape{z, 1.62F, 0.36F * reach, 0.44F, 0.36F * reach, 6, 0.98F};
  };
  hull.AddBothSides(
      Skin({intake(2.1F, 1), intake(1.4F, 1.04F), intake(-1.5F, 1.05F), intake(-3.5F, 0.9F), intake(-5.0F, 0.5F)}, 16));
  hull.Add(Skin({{2.4F, 2.5F, 0.28F, 0.3F, 0.3F},
                 {0.5F, 2.56F, 0.3F, 0.3F, 0.3F},
                 {-3.0F, 2.5F, 0.24F, 0.2F, 0.2F},
                 {-5.6F, 2.35F, 0.1F, 0.1F, 0.1F}},
                12));  // spine
  hull.Add(Cylinder({0, 1.84F, 8.2F}, {0, 1.84F, 9.0F}, 0.022F, 6));
  return hull;
}

Mesh JetWings() {
  Mesh wing = Wing({{{0.45F, 2.14F, 3.9F}, 7.6F, 0.12F},
                    {{1.15F, 2.13F, 1.7F}, 5.6F, 0.24F},
                    {{1.6F, 2.12F, 0.55F}, 4.5F, 0.22F},
                    {{5.3F, 2.02F, -2.75F}, 1.55F, 0.09F}});
  wing.Add(Box({5.36F, 2.02F, -3.3F}, {0.12F, 0.12F, 2.0F}, 0.03F));
  wing.Add(Wing({{{1.15F, 2.05F, -5.2F}, 2.7F, 0.16F}, {{3.3F, 2.0F, -7.0F}, 1.25F, 0.06F}}));
  return Mesh().AddBothSides(wing);
}

Mesh JetFins() {
  Mesh fin =
      Wing({{{1.2F, 2.3F, -3.4F}, 3.5F, 0.2F}, {{1.3F, 2.8F, -4.1F}, 2.9F, 0.17F}, {{1.75F, 4.7F, -6.2F}, 1.4F, 0.08F}},
           Vec3::UnitX());
  fin.Add(Box({1.76F, 4.62F, -6.9F}, {0.1F, 0.14F, 1.3F}, 0.04F));
  fin.Add(Wing({{{1.15F, 1.7F, -5.0F}, 1.6F, 0.08F}, {{1.35F, 1.25F, -5.6F}, 0.8F, 0.05F}}, Vec3::UnitX()));
  return Mesh().AddBothSides(fin);
}

Mesh JetNozzles() {
  const Mesh nozzle =
      Revolve({{0, 0.0F}, {0, 0.5F}, {-0.5F, 0.52F}, {-1.25F, 0.38F}, {-1.25F, 0.33F}, {-0.7F, 0.36F}, {-0.7F, 0.0F}},
              Axis::kZ, 20);
  return Mesh().AddBothSides(Moved(nozzle, At(0.62F, 2.05F, -7.0F)));
}

Mesh Missile(float length, float radius) {
  const float h = length / 2;
  Mesh missile =
      Revolve({{-h, 0.0F}, {-h, radius}, {h * 0.75F, radius}, {h * 0.93F, radius * 0.55F}, {h, 0.0F}}, Axis::kZ, 10);
  for (const float z : {-h * 0.85F, h * 0.3F}) {
    const float span = radius * (z < 0 ? 6.5F : 4.5F);
    missile.Add(Box({0, 0, z}, {span, 0.015F, length * 0.11F}, 0.004F))
        .Add(Box({0, 0, z}, {0.015F, span, length * 0.11F}, 0.004F));
  }
  return missile;
}

Mesh JetStores() {
  Mesh stores = Moved(Missile(2.9F, 0.09F), At(5.5F, 2.02F, -3.0F));
  stores.Add(Missile(3.4F, 0.11F), At(3.9F, 1.62F, -1.9F)).Add(Missile(3.6F, 0.13F), At(2.5F, 1.5F, -1.0F));
  for (const auto& [x, z] : {std::pair{3.9F, -2.2F}, {2.5F, -1.4F}})
    stores.Add(Box({x, 1.85F, z}, {0.1F, 0.36F, 1.5F}, 0.03F));
  Mesh both = Mesh().AddBothSides(stores);
  return both.Add(Moved(
      Revolve({{-2.2F, 0.0F}, {-1.6F, 0.2F}, {-0.6F, 0.33F}, {0.8F, 0.33F}, {1.7F, 0.18F}, {2.2F, 0.0F}}, Axis::kZ, 16),
      At(0, 1.12F, -0.3F)));
}

Mesh JetGear() {
  Mesh gear = Tube({{1.2F, 1.5F, -1.6F}, {1.35F, 0.4F, -1.8F}}, 0.08F, 8);
  gear.Add(Box({1.62F, 1.05F, -1.7F}, {0.04F, 0.8F, 0.8F}, 0.01F));
  gear = Mesh().AddBothSides(gear);
  gear.Add(Tube({{0, 1.5F, 4.6F}, {0, 0.35F, 4.7F}}, 0.07F, 8))
      .Add(Box({0.28F, 1.1F, 4.5F}, {0.03F, 0.6F, 1.1F}, 0.01F));
  return gear.Add(Box({-0.28F, 1.1F, 4.5F}, {0.03F, 0.6F, 1.1F}, 0.01F));
}

void DecorateJetWings(const Canvas& canvas) {
  Stencil shade = canvas.Shade("wings", Side::kTop);
  Stencil colour = canvas.Colour("wings", Side::kTop);
  for (const double s : {-1.0, 1.0}) {
    shade.Line(0.25, s * 1.6, -3.0, s * 5.2, kGroove, 0.04);    // leading-edge flap
    shade.Line(-2.9, s * 1.4, -3.75, s * 5.2, kGroove, 0.035);  // trailing flaps
    shade.Line(-2.98, s * 3.3, -4.2, s * 3.3, kGroove, 0.035);
    for (const double x : {1.9, 2.5, 3.3, 3.9, 4.6}) {
      const double front = 0.3 - (x - 1.6) * 0.89;
      shade.Line(front, s * x, -2.9 - (x - 1.4) * 0.22, s * x, kGroove, 0.022);
      shade.Rivets(front - 0.1, s * (x + 0.05), -2.85 - (x - 1.4) * 0.22, s * (x + 0.05), 0.2);
    }
    shade.Line(-1.2, s * 1.4, -3.1, s * 5.0, kGroove, 0.022);
    shade.Panel(-2.5, s * 2.0, -1.9, s * 2.4);
    shade.Panel(-2.8, s * 3.42, -2.4, s * 3.8);
    shade.Line(-6.0, s * 1.3, -7.6, s * 3.1, kGroove, 0.03);
    colour.Path({{-0.4, s * 1.75}, {-2.75, s * 1.75}, {-2.75, s * 1.5}}, {44, 44, 130}, 0.04);
    DrawMark(colour, -2.0, s * 3.0, 0.62);
    colour.Fill({{-2.9, s * 4.95}, {-2.9 - 0.26, s * 5.3}, {-4.4, s * 5.3}, {-4.3, s * 4.95}}, {60, 70, 84});
    colour.Fill({{2.8, s * 0.84}, {3.6, s * 0.5}, {1.2, s * 0.6}, {1.2, s * 1.1}}, {82, 80, 74});  // walkway
  }
  colour.Text(-1.9, 4.15, "17", 0.7, {52, 48, 46});
}

void DecorateJetBody(const Canvas& canvas) {
  const Colour dark{62, 58, 56};
  Stencil top = canvas.Shade("fuselage", Side::kTop);
  for (const double z : {6.9, 5.7, 2.2, 1.2, 0.0, -1.2, -2.4, -3.6, -4.8, -6.0, -6.8})
    top.Line(z, -1.4, z, 1.4, kGroove, 0.028);
  for (const double x : {-0.95, -0.5, 0.5, 0.95}) top.Line(1.4, x, -7.0, x, kGroove, 0.025);
  for (const double s : {-1.0, 1.0}) {
    for (const double z : {0.2, -1.0, -2.2, -3.4, -4.6}) top.Panel(z - 0.25, s * 0.58, z - 0.85, s * 0.88);
    top.Grille(-5.7, s * 0.35, -5.1, s * 0.9, 6, false);
    top.Rivets(1.2, s * 1.05, -6.8, s * 1.1, 0.22);
  }
  Stencil nose = canvas.Colour("fuselage", Side::kTop);
  nose.Fill({{9.0, 0.5}, {7.1, 0.5}, {7.1, -0.5}, {9.0, -0.5}}, dark);  // radome
  nose.Box(5.75, -0.4, 6.5, 0.4, {66, 64, 60});                         // anti-glare
  nose.Hazard(-6.75, -1.1, -6.6, 1.1, {56, 56, 56}, {62, 190, 214}, 0.2);
  DrawOnBothSides(canvas, "fuselage", [&](Stencil& colour, Stencil& shade) {
    for (const double z : {6.9, 5.8, 4.6, 3.2, 2.2, 1.0, -0.4, -1.8, -3.2, -4.6, -6.0})
      shade.Line(z, 1.2, z, 2.7, kGroove, 0.028);
    shade.Line(6.8, 1.75, 2.2, 1.75, kGroove, 0.025);
    shade.Line(2.0, 1.5, -5.0, 1.55, kGroove, 0.025);
    shade.Panel(5.6, 1.65, 4.9, 1.95);
    shade.Panel(4.4, 1.6, 3.6, 1.95);
    shade.Panel(1.6, 1.35, 0.6, 1.8);
    shade.Rivets(2.0, 1.85, -6.5, 1.85, 0.24);
    colour.Fill({{9.0, 1.2}, {7.1, 1.2}, {7.1, 2.6}, {9.0, 2.6}}, dark);
    colour.Text(5.2, 2.12, "17", 0.42, {52, 48, 46});
    colour.Fill({{2.6, 2.35}, {2.9, 2.05}, {2.6, 1.75}, {2.72, 1.75}, {3.06, 2.05}, {2.72, 2.35}}, {40, 44, 160});
    colour.Fill({{4.3, 1.52}, {4.3, 1.44}, {3.3, 1.4}, {3.3, 1.48}}, {40, 40, 40});
  });
  Stencil intakes = canvas.Colour("fuselage", Side::kFront);
  for (const double x : {-0.98, 0.98}) intakes.Box(x - 0.29, 1.32, x + 0.29, 1.9, {26, 26, 26});
}

void DecorateJet(const Canvas& canvas) {
  DecorateJetWings(canvas);
  DecorateJetBody(canvas);
  DrawOnBothSides(canvas, "fins", [](Stencil& colour, Stencil& shade) {
    shade.Line(-6.2, 2.4, -7.3, 4.5, kGroove, 0.035);
    shade.Line(-4.4, 3.0, -6.9, 3.0, kGroove, 0.025);
    shade.Line(-5.2, 3.8, -7.2, 3.8, kGroove, 0.025);
    colour.Text(-5.75, 3.36, "A17", 0.42, {46, 44, 44});
    colour.Fill({{-5.55, 3.95}, {-7.35, 3.95}, {-7.4, 4.2}, {-5.75, 4.2}}, {44, 52, 165});
    colour.Fill({{-5.75, 4.24}, {-7.4, 4.24}, {-7.4, 4.34}, {-5.85, 4.34}}, kWhite);
  });
  const Colour frame = Pigment(Rgb(110, 120, 128));
  Stencil canopy = canvas.Colour("canopy", Side::kTop);
  for (const double z : {5.2, 3.6, 2.35}) canopy.Line(z, -0.7, z, 0.7, frame, 0.1);
  DrawOnBothSides(canvas, "canopy", [&](Stencil& colour, Stencil&) {
    for (const double z : {5.15, 3.6, 2.4}) colour.Line(z, 1.9, z - 0.1, 3.2, frame, 0.1);
    colour.Line(6.2, 2.3, 1.8, 2.36, frame, 0.12);
  });
}

Mesh JetCanopy() {
  return Skin({{5.9F, 2.3F, 0.06F, 0.06F, 0.2F},
               {5.2F, 2.35F, 0.36F, 0.36F, 0.3F},
               {4.2F, 2.42F, 0.46F, 0.55F, 0.4F},
               {3.1F, 2.46F, 0.46F, 0.5F, 0.4F},
               {2.0F, 2.5F, 0.3F, 0.32F, 0.3F}},
              18);
}

void AddWheel(Asset& asset, float radius, float width, std::vector<Eigen::Affine3f> places) {
  Part& wheel = asset.Add("wheel", WheelMesh(radius, width, 18), Wheel(radius, radius * 0.58F, kSteel, 5));
  wheel.share_sides = true;
  wheel.density = 0.7F;
  wheel.places = std::move(places);
}

}  // namespace

Asset Helicopter() {
  Asset asset{.name = "helicopter", .length_m = 15};
  asset.Add("fuselage", HelicopterFuselage(), HelicopterCamouflage());
  asset.Add("canopy", HelicopterCanopy(), Glass(5)).weather = 0.4F;
  asset.Add("wings", HelicopterWings(), HelicopterCamouflage());
  Part& stores = asset.Add("stores", HelicopterStores(), [](const Surface& s) {
    const bool band = std::abs(s.position.z() - 0.55F) < 0.06F;
    return band ? Rgb(190, 160, 60) : Rgb(66, 68, 54);
  });
  stores.density = 0.7F;
  asset.Add("gear", HelicopterGear(), Coat(Rgb(62, 62, 56), 0.1F)).density = 0.35F;
  Part& rotor = asset.Add("rotor", RotorBlade(0.45F, 6.9F, 0.52F, 0.07F, 0.28F), [](const Surface& s) {
    const float x = s.position.x();
    if (x > 6.45F && x < 6.7F) return Rgb(190, 160, 60);
    return Bgr((s.position.z() > 0.17F ? Rgb(84, 84, 82) : Rgb(52, 53, 52)) *
               (1 + 0.08F * Fractal(s.position * 2, 4, 3)));
  });
  rotor.places.clear();
  for (int i = 0; i < 4; ++i)
    rotor.places.push_back(At(0, 3.76F, -0.15F) * Turn(Axis::kY, 45 + 90.0F * static_cast<float>(i)));
  Part& tail_rotor = asset.Add(
      "tail_rotor", Moved(RotorBlade(0.1F, 1.35F, 0.24F, 0.04F, 0), Turn(Axis::kX, 90)), [](const Surface& s) {
        return s.position.x() > 1.1F ? Rgb(178, 60, 48)
                                     : (s.position.x() > 0.85F ? Rgb(215, 212, 205) : Rgb(54, 55, 54));
      });
  tail_rotor.places.clear();
  for (int i = 0; i < 4; ++i)
    tail_rotor.places.push_back(At(0.42F, 3.75F, -8.5F) * Turn(Axis::kX, 20 + 90.0F * static_cast<float>(i)) *
                                Turn(Axis::kY, 90));
  AddWheel(asset, 0.36F, 0.24F,
           {At(1.18F, 0.36F, 1.75F), At(-1.18F, 0.36F, 1.75F) * Turn(Axis::kY, 180), At(0.02F, 0.36F, -7.95F)});
  asset.decorate = DecorateHelicopter;
  asset.weather = {.dust = Rgb(120, 112, 94), .dust_height_m = 0.5F, .dust_fraction = 0.3F, .seed = 13};
  return asset;
}

Asset Jet() {
  Asset asset{.name = "jet", .length_m = 17};
  asset.Add("fuselage", JetFuselage(), JetCamouflage());
  asset.Add("wings", JetWings(), JetCamouflage());
  asset.Add("fins", JetFins(), JetCamouflage());
  Part& canopy = asset.Add("canopy", JetCanopy(), Glass(9));
  canopy.weather = 0.3F;
  asset
      .Add("nozzles", JetNozzles(),
           [](const Surface& s) {
             const float petals = std::sin(std::atan2(s.position.y() - 2.05F, std::abs(s.position.x()) - 0.62F) * 14);
             return Bgr(Mix(Rgb(120, 112, 104), Rgb(58, 54, 52), Ramp(-s.position.z(), 7.0F, 8.2F)) *
                        (petals > 0.7F ? 0.6F : 1.0F));
           })
      .density = 0.6F;
  asset
      .Add("stores", JetStores(),
           [](const Surface& s) {
             const float band = std::fmod(s.position.z() + 20, 1.1F);
             return band < 0.08F ? Rgb(70, 80, 60) : Bgr(Rgb(196, 198, 196) * (1 + 0.05F * Noise(s.position * 3, 3)));
           })
      .density = 0.6F;
  asset.Add("gear", JetGear(), Coat(Rgb(205, 206, 202))).density = 0.3F;
  AddWheel(asset, 0.38F, 0.26F,
           {At(1.4F, 0.38F, -1.8F), At(-1.4F, 0.38F, -1.8F) * Turn(Axis::kY, 180), At(0.1F, 0.38F, 4.72F),
            At(-0.1F, 0.38F, 4.72F) * Turn(Axis::kY, 180)});
  asset.decorate = DecorateJet;
  asset.weather = {.dust = Rgb(120, 116, 108),
                   .dust_height_m = 0.3F,
                   .dust_fraction = 0.2F,
                   .streaks = 0.12F,
                   .stains = 0.13F,
                   .seed = 14};
  return asset;
}

}  // namespace victorious::assets
