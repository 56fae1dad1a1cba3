// A motor boat on its trailer, and a small aeroplane.
#include <cmath>
#include <utility>

#include "assets/make/catalogue.h"
#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

// --- Boat on a trailer -----------------------------------------------------------------------------------------------

Mesh BoatHull() {
  const auto rib = [](float z, float half, float keel, float deck) {
    return Ring{{0, keel, z},
                {half * 0.6F, keel + 0.18F, z},
                {half * 0.92F, std::lerp(keel, deck, 0.5F), z},
                {half, deck - 0.1F, z},
                {half * 0.96F, deck, z},
                {half * 0.5F, deck + 0.04F, z},
                {0, deck + 0.06F, z},
                {-half * 0.5F, deck + 0.04F, z},
                {-half * 0.96F, deck, z},
                {-half, deck - 0.1F, z},
                {-half * 0.92F, std::lerp(keel, deck, 0.5F), z},
                {-half * 0.6F, keel + 0.18F, z}};
  };
  return Loft({rib(3.35F, 0.08F, 1.35F, 1.95F), rib(3.0F, 0.42F, 1.1F, 1.92F), rib(2.2F, 0.82F, 0.88F, 1.86F),
               rib(1.0F, 1.08F, 0.75F, 1.8F), rib(-1.0F, 1.16F, 0.7F, 1.75F), rib(-3.0F, 1.1F, 0.7F, 1.72F)});
}

Mesh BoatCabin() {
  Mesh cabin =
      Tapered(Extrude(Rounded({{2.0F, 1.8F}, {1.2F, 2.15F}, {0.6F, 2.55F}, {0.4F, 2.55F}, {0.3F, 1.75F}}, 0.08F, 2),
                      Axis::kX, -0.8F, 0.8F, 0.06F),
              1.8F, 0.2F);
  return cabin;
}

Mesh BoatInside() {
  Mesh seats;
  for (const float x : {-0.55F, 0.55F}) {
    seats.Add(Box({x, 1.95F, -0.35F}, {0.55F, 0.3F, 0.5F}, 0.06F))
        .Add(Box({x, 2.2F, -0.6F}, {0.55F, 0.5F, 0.12F}, 0.05F));
  }
  seats.Add(Box({0, 1.92F, -2.2F}, {1.9F, 0.28F, 0.6F}, 0.07F))
      .AddBothSides(Box({0.95F, 1.9F, -1.4F}, {0.25F, 0.22F, 1.2F}, 0.06F));
  return seats;
}

Mesh BoatMetal() {
  Mesh metal = Tube({{0.1F, 2.25F, 3.2F}, {0.75F, 2.25F, 2.2F}, {0.95F, 2.2F, 1.2F}}, 0.025F, 6);
  for (const auto& [x, z] : {std::pair{0.45F, 2.75F}, {0.8F, 2.0F}, {0.92F, 1.3F}})
    metal.Add(Cylinder({x, 1.85F, z}, {x, 2.23F, z}, 0.02F, 5));
  Mesh both = Mesh().AddBothSides(metal);
  both.Add(
      Tube({{-1.0F, 1.75F, -0.9F}, {-0.95F, 2.75F, -1.0F}, {0.95F, 2.75F, -1.0F}, {1.0F, 1.75F, -0.9F}}, 0.045F, 8));
  return both.Add(Cylinder({0, 2.75F, -1.0F}, {0, 3.2F, -1.05F}, 0.02F, 5));
}

Mesh TrailerFrame() {
  Mesh frame = Tube({{0, 0.5F, 4.2F}, {0.7F, 0.52F, 2.2F}, {0.75F, 0.52F, -3.1F}}, 0.07F, 6);
  frame = Mesh().AddBothSides(frame);
  for (const float z : {2.2F, 0.5F, -1.2F, -3.0F}) frame.Add(Cylinder({-0.8F, 0.52F, z}, {0.8F, 0.52F, z}, 0.06F, 6));
  for (const float z : {-0.6F, -1.5F}) frame.AddBothSides(Box({1.12F, 0.78F, z}, {0.32F, 0.06F, 0.8F}, 0.02F));
  frame.Add(Cylinder({0, 0.1F, 3.8F}, {0, 0.9F, 3.8F}, 0.05F, 8)).Add(Box({0, 1.3F, 3.4F}, {0.2F, 0.7F, 0.2F}, 0.03F));
  return frame.Add(Box({0, 0.55F, -3.2F}, {2.2F, 0.14F, 0.08F}, 0.02F));
}

void DecorateBoat(const Canvas& canvas) {
  const Colour navy{96, 58, 32}, orange{52, 112, 214}, teak{92, 132, 168};
  DrawOnBothSides(canvas, "hull", [&](Stencil& colour, Stencil&) {
    colour.Fill({{3.4, 1.5}, {-3.1, 1.22}, {-3.1, 1.4}, {3.4, 1.75}}, navy);
    colour.Fill({{3.2, 1.42}, {-3.1, 1.1}, {-3.1, 1.18}, {3.2, 1.48}}, orange);
    colour.Text(-1.9, 1.56, "SEA 12", 0.24, navy);
  });
  Stencil deck = canvas.Colour("hull", Side::kTop);
  deck.Box(-2.9, -0.82, 0.35, 0.82, teak);
  for (double x = -0.8; x < 0.82; x += 0.13) deck.Line(-2.9, x, 0.35, x, {58, 84, 110}, 0.025);
  deck.Fill({{3.0, 0.0}, {2.2, 0.45}, {1.9, 0.45}, {1.9, -0.45}, {2.2, -0.45}}, {186, 196, 150});
  deck.Frame(2.2, -0.25, 2.65, 0.25, {110, 112, 114}, 0.05);
  for (const double s : {-1.0, 1.0})
    deck.Path({{3.2, s * 0.2}, {2.2, s * 0.72}, {1.0, s * 0.97}, {-2.9, s * 1.0}}, navy, 0.07);
  Stencil cabin = canvas.Colour("cabin", Side::kTop);
  DrawWindow(cabin, {{1.15, -0.62}, {1.15, 0.62}, {0.66, 0.56}, {0.66, -0.56}});
  cabin.Line(0.9, -0.62, 0.9, 0.62, kWhite, 0.05);
  cabin.Box(1.35, -0.3, 1.8, 0.3, {70, 62, 54});
  DrawOnBothSides(canvas, "cabin", [](Stencil& colour, Stencil&) {
    DrawWindow(colour, {{0.45, 2.05}, {1.1, 2.05}, {0.65, 2.42}, {0.45, 2.42}});
  });
}

// --- Propeller aeroplane ---------------------------------------------------------------------------------------------

Mesh PlaneFuselage() {
  std::vector<Ring> rings;
  for (const SectionShape& shape : {SectionShape{3.0F, 1.35F, 0.2F, 0.2F, 0.2F},
                                    {2.9F, 1.35F, 0.42F, 0.36F, 0.36F, 2.6F},
                                    {1.9F, 1.38F, 0.52F, 0.44F, 0.48F, 3},
                                    {1.2F, 1.45F, 0.56F, 0.5F, 0.55F, 3.4F},
                                    {0.5F, 1.55F, 0.58F, 0.72F, 0.62F, 3.6F},
                                    {-0.9F, 1.55F, 0.54F, 0.7F, 0.58F, 3.4F},
                                    {-1.8F, 1.52F, 0.42F, 0.48F, 0.44F, 3},
                                    {-4.0F, 1.6F, 0.2F, 0.22F, 0.2F, 2.5F},
                                    {-5.0F, 1.68F, 0.08F, 0.14F, 0.1F, 2}}) {
    rings.push_back(Section(shape, 18));
  }
  return Loft(rings);
}

Mesh PlaneWings() {
  Mesh wing = Wing({{{0, 2.28F, 0.95F}, 1.6F, 0.22F},
                    {{2.6F, 2.32F, 0.95F}, 1.6F, 0.2F},
                    {{5.3F, 2.42F, 0.75F}, 1.15F, 0.12F},
                    {{5.5F, 2.43F, 0.6F}, 0.8F, 0.06F}});
  wing.Add(Wing({{{0.05F, 1.72F, -3.9F}, 1.1F, 0.1F}, {{1.75F, 1.74F, -4.15F}, 0.75F, 0.05F}}));
  return Mesh().AddBothSides(wing);
}

Mesh PlaneFin() {
  return Wing({{{0, 1.75F, -3.4F}, 1.7F, 0.12F}, {{0, 2.2F, -4.0F}, 1.25F, 0.1F}, {{0, 3.0F, -4.5F}, 0.8F, 0.05F}},
              Vec3::UnitX());
}

Mesh PlaneGear() {
  Mesh gear = Tube({{0.45F, 1.05F, 0.2F}, {1.1F, 0.42F, 0.15F}}, 0.05F, 6);
  gear.Add(Cylinder({0.5F, 1.1F, 0.6F}, {2.5F, 2.22F, 0.55F}, 0.045F, 6));
  gear.Add(Loft({Section({0.62F, 0.36F, 0.04F, 0.04F, 0.04F, 2, 1.15F}, 10),
                 Section({0.4F, 0.38F, 0.13F, 0.2F, 0.12F, 2, 1.15F}, 10),
                 Section({-0.1F, 0.4F, 0.12F, 0.18F, 0.1F, 2, 1.15F}, 10),
                 Section({-0.5F, 0.38F, 0.03F, 0.04F, 0.04F, 2, 1.15F}, 10)}));
  gear = Mesh().AddBothSides(gear);
  return gear.Add(Cylinder({0, 1.1F, 2.3F}, {0, 0.3F, 2.5F}, 0.05F, 8));
}

void DecoratePlane(const Canvas& canvas) {
  const Colour red{44, 40, 168}, navy{96, 54, 36};
  Stencil wings = canvas.Colour("wings", Side::kTop);
  for (const double s : {-1.0, 1.0}) {
    for (int i = 0; i < 5; ++i) {  // rays at the tips
      const double x0 = 3.2 + 0.5 * i, x1 = x0 + 0.26;
      wings.Fill({{1.2, s * x0}, {1.2, s * x1}, {-0.9, s * (x1 + 0.35)}, {-0.9, s * (x0 + 0.35)}}, red);
    }
    wings.Box(1.2, s * 0.5, 0.75, s * 2.9, red);
    wings.Fill({{-3.9, s * 1.0}, {-3.9, s * 1.3}, {-5.2, s * 1.5}, {-5.2, s * 1.2}}, red);
  }
  wings.Text(0.15, 1.85, "V-27", 0.48, navy);
  Stencil lines = canvas.Shade("wings", Side::kTop);
  for (const double s : {-1.0, 1.0}) {
    lines.Line(-0.3, s * 0.6, -0.3, s * 2.6, kGroove, 0.03);
    lines.Line(-0.25, s * 2.7, -0.1, s * 5.2, kGroove, 0.03);
    lines.Line(-0.25, s * 2.65, -0.7, s * 2.65, kGroove, 0.03);
    for (const double x : {1.2, 1.8, 2.4, 3.0, 3.6, 4.2, 4.8}) lines.Rivets(0.9, s * x, -0.2, s * x, 0.12);
    lines.Disc(0.3, s * 1.5, 0.09, kSoot);
    lines.Line(-4.75, s * 0.2, -4.75, s * 1.6, kGroove, 0.03);
  }
  DrawOnBothSides(canvas, "fuselage", [&](Stencil& colour, Stencil& shade) {
    colour.Fill({{3.0, 1.3}, {3.0, 1.55}, {0.8, 1.45}, {-5.0, 1.72}, {-5.0, 1.62}, {0.6, 1.2}}, red);
    colour.Fill({{2.9, 1.15}, {2.9, 1.24}, {0.6, 1.12}, {-5.0, 1.6}, {-5.0, 1.57}, {0.5, 1.02}}, navy);
    DrawWindow(colour, {{0.2, 1.68}, {0.95, 1.62}, {0.66, 2.1}, {0.2, 2.14}});
    DrawWindow(colour, {{-0.8, 1.66}, {0.1, 1.68}, {0.1, 2.14}, {-0.7, 2.08}});
    shade.Frame(-0.0, 1.0, 0.9, 2.18, kGroove, 0.025);
    for (const double z : {1.9, 1.25, -1.1, -1.9, -2.8, -3.6}) shade.Line(z, 0.9, z, 2.2, kGroove, 0.025);
    shade.Grille(2.6, 1.1, 2.1, 1.28, 4);
    colour.Text(-2.5, 1.83, "V-27", 0.3, navy);
  });
  Stencil top = canvas.Colour("fuselage", Side::kTop);
  top.Fill({{2.95, -0.14}, {2.95, 0.14}, {1.25, 0.3}, {1.25, -0.3}}, {62, 62, 60});
  DrawWindow(top, {{1.15, -0.46}, {1.15, 0.46}, {0.66, 0.42}, {0.66, -0.42}});
  top.Fill({{-1.2, -0.12}, {-1.2, 0.12}, {-4.6, 0.04}, {-4.6, -0.04}}, red);
  DrawOnBothSides(canvas, "fin", [&](Stencil& colour, Stencil&) {
    colour.Fill({{-4.1, 2.3}, {-5.4, 2.3}, {-5.4, 2.55}, {-4.25, 2.55}}, red);
    colour.Fill({{-4.3, 2.65}, {-5.4, 2.65}, {-5.4, 2.75}, {-4.4, 2.75}}, navy);
  });
}

}  // namespace

Asset BoatTrailer() {
  Asset asset{.name = "boat_trailer", .length_m = 8};
  asset.Add("hull", BoatHull(), [](const Surface& s) {
    const bool low = s.position.y() < 1.05F && s.normal.y() < 0.5F;
    return Bgr((low ? Rgb(120, 48, 42) : Rgb(218, 216, 208)) * (1 + 0.04F * Fractal(s.position, 161, 3)));
  });
  asset.Add("cabin", BoatCabin(), Coat(Rgb(214, 212, 204)));
  asset.Add("seats", BoatInside(), [](const Surface& s) {
    return std::fmod(s.position.x() + 20, 0.28F) < 0.05F ? Rgb(200, 194, 178) : Rgb(54, 84, 116);
  });
  Mesh motor = Box({0, 1.95F, -3.25F}, {0.5F, 0.6F, 0.65F}, 0.12F);
  motor.Add(Box({0, 1.25F, -3.2F}, {0.16F, 1.1F, 0.3F}, 0.04F))
      .Add(Cylinder({0, 0.75F, -3.05F}, {0, 0.75F, -3.5F}, 0.09F, 10));
  asset.Add("motor", std::move(motor), Coat(Rgb(48, 50, 56))).density = 0.8F;
  asset.Add("metal", BoatMetal(), Metal(Rgb(186, 190, 192))).density = 0.4F;
  asset.Add("trailer", TrailerFrame(), Metal(Rgb(142, 146, 148))).density = 0.4F;
  AddWheels(asset, {.radius = 0.34F, .width = 0.22F, .x = 1.12F, .z = {-0.6F, -1.5F}, .rim = kSteel, .bolts = 5});
  asset.decorate = DecorateBoat;
  asset.weather = {.dust_height_m = 0.2F, .streaks = 0.12F, .stains = 0.06F, .seed = 25};
  return asset;
}

Asset PropellerPlane() {
  Asset asset{.name = "propeller_plane", .length_m = 8.3F};
  const Bgr white = Rgb(220, 220, 214);
  asset.Add("fuselage", PlaneFuselage(), Coat(white, 0.03F));
  asset.Add("wings", PlaneWings(), Coat(white, 0.03F));
  asset.Add("fin", PlaneFin(), Coat(white, 0.03F));
  asset.Add("gear", PlaneGear(), Coat(Rgb(206, 204, 198))).density = 0.4F;
  Mesh propeller = Mesh().AddBothSides(
      Moved(Wing({{{0.05F, 0, 0.06F}, 0.12F, 0.05F}, {{0.5F, 0, 0.1F}, 0.2F, 0.04F}, {{0.98F, 0, 0.05F}, 0.1F, 0.02F}}),
            Turn(Axis::kX, 55)));
  propeller.Add(Revolve({{-0.12F, 0.0F}, {-0.12F, 0.17F}, {0.08F, 0.14F}, {0.28F, 0.0F}}, Axis::kZ, 14));
  Part& turned = asset.Add("propeller", std::move(propeller), [](const Surface& s) {
    const float x = std::abs(s.position.x());
    return x > 0.85F ? Rgb(206, 170, 60) : (x < 0.18F ? Rgb(166, 44, 42) : Rgb(58, 58, 58));
  });
  turned.places = {At(0, 1.35F, 3.1F) * Turn(Axis::kZ, 28)};
  Part& wheel = asset.Add("wheel", WheelMesh(0.27F, 0.18F, 18), Wheel(0.27F, 0.15F, kSteel, 4));
  wheel.share_sides = true;
  wheel.density = 0.6F;
  wheel.places = {At(1.15F, 0.27F, 0.12F), At(-1.15F, 0.27F, 0.12F) * Turn(Axis::kY, 180), At(0, 0.27F, 2.5F)};
  asset.decorate = DecoratePlane;
  asset.weather = {
      .dust_height_m = 0.2F, .dust_fraction = 0.25F, .streaks = 0.07F, .stains = 0.06F, .grain = 0.02F, .seed = 26};
  return asset;
}

}  // namespace victorious::assets
