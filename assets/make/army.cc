// The army's vehicles: a jeep-like truck and a battle tank.
#include <cmath>

#include "assets/make/catalogue.h"
#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

// --- Jeep ------------------------------------------------------------------------------------------------------------

const Bgr kSand = Rgb(152, 136, 101);
const Bgr kOlive = Rgb(84, 88, 58);
const Bgr kEarth = Rgb(94, 70, 49);

Paint JeepCamouflage() {
  return Camouflage(kSand, {{kOlive, 0.42F}, {kEarth, 0.26F}, {Rgb(44, 46, 40), 0.12F}}, 0.62F, 21);
}

Mesh JeepBody() {
  const Polygon outline =
      SideOutline({{2.22F, 0.55F}, {2.26F, 0.8F}, {2.18F, 1.12F}, {0.85F, 1.24F}, {-2.2F, 1.22F}, {-2.26F, 0.6F}},
                  0.52F, {-1.45F, 1.45F}, 0.46F, 0.6F);
  Mesh body = Extrude(outline, Axis::kX, -0.98F, 0.98F, 0.045F);
  body.Add(Box({0, 0.55F, 0}, {1.3F, 0.3F, 4.2F}, 0.04F));       // the frame
  body.Add(Box({0, 0.68F, 2.36F}, {1.9F, 0.2F, 0.16F}, 0.03F));  // bumper
  body.Add(Box({0, 0.66F, -2.33F}, {1.9F, 0.16F, 0.12F}, 0.03F));
  body.Add(Box({0, 1.22F, 1.5F}, {1.0F, 0.1F, 1.1F}, 0.05F));  // the bonnet's bulge
  for (const float z : {-1.45F, 1.45F}) {                      // mudguards
    const Polygon guard = {{z - 0.66F, 0.86F}, {z - 0.5F, 1.12F},  {z + 0.5F, 1.12F},  {z + 0.66F, 0.86F},
                           {z + 0.6F, 0.86F},  {z + 0.47F, 1.07F}, {z - 0.47F, 1.07F}, {z - 0.6F, 0.86F}};
    body.AddBothSides(Extrude(guard, Axis::kX, 0.9F, 1.05F));
  }
  return body;
}

Mesh JeepCab() {
  const Polygon outline = Rounded({{0.98F, 1.2F}, {0.5F, 1.83F}, {-0.85F, 1.88F}, {-0.9F, 1.2F}}, 0.07F, 2);
  return Tapered(Extrude(outline, Axis::kX, -0.93F, 0.93F, 0.05F), 1.2F, 0.13F);
}

/// Cloth over hoops: it sags between them.
Mesh JeepTilt() {
  std::vector<Ring> rings;
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const float sag = i % 4 == 0 ? 0.0F : (i % 4 == 2 ? 0.05F : 0.035F);
    const float z = -0.86F - 1.34F * static_cast<float>(i) / kSteps;
    rings.push_back(Section({z, 1.3F, 0.9F - sag * 0.6F, 0.6F - sag, 0.12F, 4.5F}, 24));
  }
  return Loft(rings);
}

Mesh JeepGear() {
  Mesh gear = Moved(
      Revolve({{0, 0.0F}, {0, 0.46F}, {0.09F, 0.46F}, {0.09F, 0.36F}, {0.05F, 0.36F}, {0.05F, 0.0F}}, Axis::kY, 20),
      At(0, 1.84F, -0.2F));
  gear.Add(Cylinder({0, 1.9F, 0.1F}, {0, 2.1F, 0.16F}, 0.04F, 6));  // the gun's post
  gear.Add(Box({0, 2.12F, 0.1F}, {0.13F, 0.16F, 0.6F}, 0.02F));
  gear.Add(Cylinder({0, 2.13F, 0.35F}, {0, 2.14F, 1.2F}, 0.026F, 7));
  gear.Add(Box({0, 2.13F, 0.38F}, {0.62F, 0.36F, 0.03F}, 0.005F));  // its shield
  gear.Add(Box({0.2F, 2.1F, 0.06F}, {0.22F, 0.18F, 0.3F}, 0.02F));  // ammunition
  gear.Add(Mirrors(0.95F, 1.42F, 0.8F, 0.26F)).Add(Aerial(0.8F, 1.2F, -2.1F, 1.1F));
  gear.Add(Tube({{-1.0F, 0.9F, 0.9F}, {-1.02F, 1.3F, 0.75F}, {-1.0F, 1.98F, 0.55F}}, 0.055F, 8));  // the snorkel
  gear.AddBothSides(Tube({{0.62F, 0.7F, 2.38F}, {0.62F, 1.1F, 2.34F}, {0.0F, 1.1F, 2.34F}}, 0.03F, 6));
  gear.Add(Cylinder({-0.62F, 1.34F, 2.0F}, {0.62F, 1.34F, 2.0F}, 0.1F, 10));  // a rolled net
  for (const float x : {0.28F, 0.48F, 0.68F}) gear.Add(Box({x, 0.98F, -2.38F}, {0.17F, 0.46F, 0.2F}, 0.03F));
  return gear;
}

void DecorateJeep(const Canvas& canvas) {
  DrawOnBothSides(canvas, "cab", [](Stencil& colour, Stencil& shade) {
    DrawWindow(colour, {{0.02, 1.3}, {0.7, 1.3}, {0.38, 1.74}, {0.02, 1.74}});
    DrawWindow(colour, {{-0.76, 1.3}, {-0.1, 1.3}, {-0.1, 1.74}, {-0.76, 1.74}});
    shade.Rivets(-0.84, 1.8, 0.44, 1.78, 0.09);
  });
  Stencil screen = canvas.Colour("cab", Side::kFront);
  DrawWindow(screen, {{-0.82, 1.3}, {-0.05, 1.3}, {-0.05, 1.74}, {-0.76, 1.74}});
  DrawWindow(screen, {{0.05, 1.3}, {0.82, 1.3}, {0.76, 1.74}, {0.05, 1.74}});
  Stencil roof = canvas.Shade("cab", Side::kTop);
  roof.Frame(-0.8, -0.74, 0.42, 0.74, kGroove);
  roof.Rivets(-0.8, 0.78, 0.42, 0.78, 0.1);
  roof.Rivets(-0.8, -0.78, 0.42, -0.78, 0.1);
  DrawOnBothSides(canvas, "body", [](Stencil& colour, Stencil& shade) {
    DrawDoor(colour, shade, -0.02, 0.6, 0.84, 1.2);
    DrawDoor(colour, shade, -0.86, 0.6, -0.04, 1.2);
    shade.Rivets(-2.1, 1.17, 0.8, 1.17, 0.1);
    shade.Panel(1.0, 1.06, 1.5, 1.18);
    colour.Text(0.42, 0.9, "27", 0.26, kWhite);
    colour.Box(-0.62, 0.84, -0.3, 0.92, kWhite);
    colour.Box(-2.15, 0.98, -2.0, 1.12, {40, 60, 170});
  });
  Stencil bonnet = canvas.Shade("body", Side::kTop);
  bonnet.Panel(0.95, -0.5, 2.05, 0.5);
  bonnet.Line(0.95, 0.62, 2.1, 0.62, kGroove);
  bonnet.Line(0.95, -0.62, 2.1, -0.62, kGroove);
  bonnet.Grille(1.1, -0.32, 1.42, 0.32, 6, false);
  bonnet.Panel(1.1, 0.66, 1.9, 0.92);
  bonnet.Panel(1.1, -0.92, 1.9, -0.66);
  Stencil marks = canvas.Colour("body", Side::kTop);
  marks.Fill({{1.56, 0.0}, {1.76, 0.3}, {1.9, 0.3}, {1.72, 0.0}, {1.9, -0.3}, {1.76, -0.3}}, kWhite);
  Stencil front = canvas.Shade("body", Side::kFront);
  front.Grille(-0.5, 0.8, 0.5, 1.08, 9, false);
  Stencil lamps = canvas.Colour("body", Side::kFront);
  DrawHeadlamps(lamps, 0.72, 0.96, 0.11);
  Stencil back = canvas.Colour("body", Side::kBack);
  DrawTailLamps(back, 0.85, 0.88, 0.12, 0.2);
  Stencil cloth = canvas.Colour("tilt", Side::kTop);
  cloth.Text(-1.38, 0.0, "B27", 0.36, kWhite);
  cloth.Box(-2.08, -0.62, -1.94, 0.62, {72, 110, 205});
  Stencil seams = canvas.Shade("tilt", Side::kTop);
  for (const double z : {-1.195, -1.53, -1.865}) seams.Line(z, -0.9, z, 0.9, kGroove, 0.03);
  for (const double x : {-0.45, 0.45}) seams.Line(-2.2, x, -0.86, x, Colour{105}, 0.02);
  DrawOnBothSides(canvas, "tilt", [](Stencil& colour, Stencil& shade) {
    for (const double z : {-1.195, -1.53, -1.865}) shade.Line(z, 1.2, z, 1.9, kGroove, 0.03);
    for (double z = -0.95; z > -2.2; z -= 0.15) colour.Line(z, 1.22, z, 1.34, {50, 60, 66}, 0.025);
    DrawWindow(colour, {{-1.75, 1.44}, {-1.3, 1.44}, {-1.3, 1.68}, {-1.75, 1.68}});
  });
}

// --- Tank ------------------------------------------------------------------------------------------------------------

Paint TankCamouflage() {
  return Camouflage(Rgb(98, 102, 72), {{Rgb(70, 58, 44), 0.34F}, {Rgb(40, 44, 36), 0.3F}, {Rgb(142, 136, 104), 0.13F}},
                    0.95F, 44);
}

Mesh TankHull() {
  const Polygon side = {{3.85F, 0.95F},  {3.3F, 1.32F},  {1.9F, 1.5F},  {-2.1F, 1.5F}, {-2.2F, 1.66F},
                        {-3.65F, 1.62F}, {-3.85F, 1.3F}, {-3.6F, 0.6F}, {3.3F, 0.5F}};
  Mesh hull = Extrude(side, Axis::kX, -1.15F, 1.15F, 0.06F);
  const Polygon sponson = {{3.6F, 1.12F}, {3.2F, 1.36F}, {-3.75F, 1.5F}, {-3.85F, 1.15F}};
  hull.AddBothSides(Extrude(sponson, Axis::kX, 1.1F, 1.78F, 0.05F));
  hull.AddBothSides(Box({0.7F, 0.98F, 3.72F}, {0.16F, 0.3F, 0.2F}, 0.03F));  // towing eyes
  hull.Add(Box({0, 1.1F, -3.9F}, {1.5F, 0.36F, 0.16F}, 0.04F));              // exhaust
  hull.AddBothSides(Box({1.05F, 1.52F, 3.0F}, {0.34F, 0.2F, 0.2F}, 0.04F));  // lamps
  hull.Add(Moved(Revolve({{0, 0.0F}, {0, 0.34F}, {0.07F, 0.32F}, {0.07F, 0.0F}}, Axis::kY, 16), At(0, 1.46F, 2.35F)));
  for (int i = 0; i < 3; ++i)
    hull.Add(Box({-0.4F + 0.4F * static_cast<float>(i), 1.54F, 2.76F}, {0.26F, 0.1F, 0.12F}, 0.02F));
  hull.AddBothSides(Box({1.44F, 1.58F, -2.9F}, {0.5F, 0.24F, 1.3F}, 0.04F));     // stowage
  hull.Add(Cylinder({-0.95F, 1.78F, -3.5F}, {0.95F, 1.78F, -3.5F}, 0.14F, 10));  // a log
  return hull;
}

Mesh TankTracks() {
  const Polygon loop =
      Rounded({{3.62F, 0.72F}, {3.2F, 1.1F}, {-3.3F, 1.1F}, {-3.72F, 0.75F}, {-3.0F, 0.02F}, {2.7F, 0.02F}}, 0.35F, 4);
  Mesh tracks = Extrude(loop, Axis::kX, 1.2F, 1.72F, 0.03F);
  // Shoes across the track, where they show: in front, behind and below the skirts.
  const std::size_t count = loop.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2f step = loop[(i + 1) % count] - loop[i];
    const int shoes = std::max(1, static_cast<int>(step.norm() / 0.27F));
    for (int k = 0; k < shoes; ++k) {
      const Eigen::Vector2f at = loop[i] + step * ((static_cast<float>(k) + 0.5F) / static_cast<float>(shoes));
      if (at.y() > 1.0F) continue;
      const float tilt = std::atan2(step.y(), step.x()) * 57.29578F;
      tracks.Add(Extrude(Rectangle(-0.05F, -0.28F, 0.05F, 0.28F), Axis::kY, -0.025F, 0.025F),
                 At(1.46F, std::max(at.y(), 0.035F), at.x()) * Turn(Axis::kX, -tilt));
    }
  }
  return Mesh().AddBothSides(tracks);
}

Mesh TankSkirts() {
  Mesh skirts;
  constexpr int kPlates = 7;
  for (int i = 0; i < kPlates; ++i) {
    const float front = 3.45F - 0.99F * static_cast<float>(i);
    const float foot = i == kPlates - 1 ? 0.78F : 0.56F;
    skirts.AddBothSides(Extrude(
        {{front, foot + (i == 0 ? 0.25F : 0.0F)}, {front - 0.95F, foot}, {front - 0.95F, 1.34F}, {front, 1.34F}},
        Axis::kX, 1.76F, 1.83F, 0.012F));
  }
  return skirts;
}

Mesh TankTurret() {
  const auto ring = [](float y, float shrink, float back) {
    Ring outline;
    for (const auto& [x, z] : {std::pair{0.45F, 2.05F},
                               {1.25F, 1.45F},
                               {1.5F, 0.2F},
                               {1.35F, -1.7F},
                               {0.9F, -2.35F},
                               {-0.9F, -2.35F},
                               {-1.35F, -1.7F},
                               {-1.5F, 0.2F},
                               {-1.25F, 1.45F},
                               {-0.45F, 2.05F}}) {
      outline.emplace_back(x * shrink, y, z < 0 ? z * back : z * shrink);
    }
    return outline;
  };
  Mesh turret = Loft({ring(1.5F, 0.8F, 0.8F), ring(1.72F, 1.0F, 0.98F), ring(2.0F, 0.99F, 1.0F),
                      ring(2.3F, 0.84F, 0.95F), ring(2.38F, 0.78F, 0.9F)});
  turret.AddBothSides(Box({1.5F, 1.98F, -1.05F}, {0.36F, 0.4F, 1.5F}, 0.05F));  // bins
  turret.Add(Box({0, 1.98F, -2.55F}, {1.9F, 0.42F, 0.5F}, 0.05F));              // the basket's load
  for (const float x : {-0.6F, 0.0F, 0.6F}) turret.Add(Box({x, 2.24F, -2.55F}, {0.5F, 0.2F, 0.42F}, 0.06F));
  return turret;
}

Mesh TankTurretGear() {
  Mesh gear = RoofRack(-1.05F, -2.32F, 1.05F, -2.86F, 1.8F, 0.5F);
  const Mesh hatch =
      Revolve({{0, 0.0F}, {0, 0.42F}, {0.12F, 0.4F}, {0.12F, 0.3F}, {0.16F, 0.28F}, {0.18F, 0.0F}}, Axis::kY, 18);
  gear.Add(hatch, At(-0.5F, 2.34F, -0.35F)).Add(hatch, At(0.55F, 2.34F, -0.6F));
  gear.Add(Box({-0.62F, 2.52F, 0.62F}, {0.34F, 0.36F, 0.3F}, 0.05F));  // gunner's sight
  gear.Add(Moved(Revolve({{0, 0.0F}, {0, 0.2F}, {0.34F, 0.2F}, {0.4F, 0.14F}, {0.4F, 0.0F}}, Axis::kY, 14),
                 At(0.15F, 2.36F, 0.35F)));
  gear.Add(Cylinder({-0.5F, 2.5F, 0.05F}, {-0.5F, 2.72F, 0.1F}, 0.04F, 6));  // machine gun
  gear.Add(Box({-0.5F, 2.76F, 0.05F}, {0.14F, 0.15F, 0.55F}, 0.02F))
      .Add(Cylinder({-0.5F, 2.77F, 0.3F}, {-0.5F, 2.8F, 1.15F}, 0.026F, 7));
  gear.Add(Box({-0.7F, 2.73F, 0.05F}, {0.24F, 0.18F, 0.32F}, 0.02F));
  for (int i = 0; i < 4; ++i) {  // smoke pots
    const float z = 0.95F - 0.2F * static_cast<float>(i);
    gear.AddBothSides(Cylinder({1.3F, 2.02F, z}, {1.55F, 2.2F, z + 0.12F}, 0.06F, 8));
  }
  gear.Add(Aerial(-1.0F, 2.3F, -1.95F, 1.5F)).Add(Aerial(1.0F, 2.3F, -1.95F, 1.2F));
  gear.Add(Cylinder({0.3F, 2.36F, -1.9F}, {0.3F, 2.75F, -1.9F}, 0.05F, 8))
      .Add(Box({0.3F, 2.8F, -1.9F}, {0.16F, 0.12F, 0.16F}, 0.03F));
  return gear;
}

Mesh TankGun() {
  Mesh gun = Moved(Revolve({{0, 0.0F},
                            {0, 0.24F},
                            {0.5F, 0.2F},
                            {0.55F, 0.115F},
                            {1.7F, 0.11F},
                            {1.72F, 0.17F},
                            {2.4F, 0.17F},
                            {2.45F, 0.1F},
                            {4.3F, 0.085F},
                            {4.32F, 0.11F},
                            {4.55F, 0.11F},
                            {4.55F, 0.06F},
                            {4.3F, 0.055F},
                            {4.3F, 0.0F}},
                           Axis::kZ, 16),
                   At(0, 1.98F, 1.75F));
  gun.Add(Box({0, 1.98F, 1.85F}, {0.85F, 0.55F, 0.5F}, 0.08F));  // mantlet
  return gun.Add(Box({0, 2.11F, 6.2F}, {0.06F, 0.09F, 0.1F}, 0.01F));
}

void DecorateTank(const Canvas& canvas) {
  Stencil deck = canvas.Shade("hull", Side::kTop);
  for (const double x : {-0.72, 0.0, 0.72}) deck.Grille(-3.35, x - 0.3, -2.35, x + 0.3, 9, false);
  deck.Panel(-2.15, -1.1, -1.75, 1.1);
  deck.Panel(1.75, -1.0, 2.0, 1.0);
  deck.Line(3.0, -1.15, 3.0, 1.15, kGroove);
  for (const double x : {-1.45, 1.45}) {
    for (const double z : {-3.7, -2.1, -0.6, 0.9, 2.3}) deck.Panel(z, x - 0.3, z + 1.3, x + 0.3);
  }
  Stencil deck_marks = canvas.Colour("hull", Side::kTop);
  deck_marks.Box(-2.12, -0.9, -1.8, -0.2, {72, 110, 205});
  DrawOnBothSides(canvas, "skirts", [](Stencil& colour, Stencil& shade) {
    for (int i = 0; i < 7; ++i) {
      const double z = 3.45 - 0.99 * i;
      shade.Rivets(z - 0.85, 1.27, z - 0.1, 1.27, 0.18);
      shade.Rivets(z - 0.85, 0.86, z - 0.1, 0.86, 0.37);
      if (i == 2) colour.Text(z - 0.48, 1.06, "31", 0.34, kWhite);
      if (i == 5)
        colour.Fill(
            {{z - 0.8, 0.92}, {z - 0.5, 1.2}, {z - 0.2, 0.92}, {z - 0.33, 0.92}, {z - 0.5, 1.08}, {z - 0.67, 0.92}},
            kWhite);
    }
  });
  Stencil roof = canvas.Shade("turret", Side::kTop);
  roof.Panel(-1.75, -0.85, -1.05, -0.1);
  roof.Panel(-1.75, 0.1, -1.05, 0.85);
  roof.Panel(0.85, 0.1, 1.3, 0.7);
  roof.Panel(0.75, -0.85, 1.25, -0.2);
  roof.Line(-0.95, -1.1, -0.95, 1.1, kGroove, 0.03);
  roof.Line(0.72, -1.05, 0.72, 1.05, kGroove, 0.03);
  roof.Rivets(-2.0, -0.95, -2.0, 0.95, 0.16);
  roof.Grille(-2.7, -0.9, -2.4, 0.9, 12, false);
  Stencil signs = canvas.Colour("turret", Side::kTop);
  signs.Text(-1.38, 0.48, "A3", 0.36, kWhite);
  DrawOnBothSides(canvas, "turret", [](Stencil& colour, Stencil& shade) {
    shade.Panel(-1.75, 1.82, -1.1, 2.14);
    shade.Panel(-1.02, 1.82, -0.35, 2.14);
    shade.Rivets(-0.2, 1.72, 1.2, 1.76, 0.16);
    colour.Text(0.28, 1.98, "314", 0.3, kWhite);
  });
  Stencil rear = canvas.Shade("hull", Side::kBack);
  rear.Grille(-0.7, 0.98, 0.7, 1.24, 12, false);
  Stencil lamps = canvas.Colour("hull", Side::kBack);
  DrawTailLamps(lamps, 1.5, 1.3, 0.14, 0.14);
  Stencil nose = canvas.Shade("hull", Side::kFront);
  nose.Rivets(-1.0, 0.85, 1.0, 0.85, 0.2);
}

}  // namespace

Asset Jeep() {
  Asset asset{.name = "jeep", .length_m = 4.6F};
  asset.Add("body", JeepBody(), JeepCamouflage());
  asset.Add("cab", JeepCab(), JeepCamouflage());
  asset.Add("tilt", JeepTilt(), Coat(Rgb(112, 106, 80), 0.09F));
  asset.Add("gear", JeepGear(), Coat(Rgb(62, 62, 48))).density = 0.3F;
  AddWheels(asset,
            {.radius = 0.46F, .width = 0.3F, .x = 0.87F, .z = {1.45F, -1.45F}, .rim = Rgb(92, 90, 66), .bolts = 5});
  Part& spare = asset.Add("spare", Moved(WheelMesh(0.44F, 0.28F), Turn(Axis::kY, 90)), [](const Surface& s) {
    return Wheel(0.44F, 0.27F, Rgb(92, 90, 66), 5)({{s.position.z(), s.position.y(), s.position.x()}, s.normal});
  });
  spare.density = 0.6F;
  spare.places = {At(-0.45F, 1.05F, -2.42F) * Turn(Axis::kY, 180)};
  asset.decorate = DecorateJeep;
  asset.weather = {.dust = Rgb(150, 134, 108), .dust_height_m = 0.45F, .seed = 11};
  return asset;
}

Asset Tank() {
  Asset asset{.name = "tank", .length_m = 9.8F};
  asset.Add("hull", TankHull(), TankCamouflage());
  asset.Add("turret", TankTurret(), TankCamouflage());
  asset.Add("skirts", TankSkirts(), TankCamouflage());
  asset
      .Add("gun", TankGun(),
           Camouflage(Rgb(98, 102, 72), {{Rgb(70, 58, 44), 0.36F}, {Rgb(40, 44, 36), 0.28F}}, 0.7F, 61))
      .density = 0.8F;
  asset.Add("gear", TankTurretGear(), Coat(Rgb(60, 62, 50))).density = 0.35F;
  Part& tracks = asset.Add("tracks", TankTracks(), Coat(Rgb(58, 54, 50), 0.2F));
  tracks.density = 0.4F;
  Part& wheel = asset.Add("wheel", WheelMesh(0.36F, 0.3F, 12), Wheel(0.36F, 0.26F, Rgb(84, 86, 62), 6));
  wheel.share_sides = true;
  wheel.density = 0.7F;
  wheel.places.clear();
  for (int i = 0; i < 7; ++i) {
    const float z = 2.6F - 0.9F * static_cast<float>(i);
    wheel.places.push_back(At(1.62F, 0.42F, z));
    wheel.places.push_back(At(-1.62F, 0.42F, z) * Turn(Axis::kY, 180));
  }
  asset.decorate = DecorateTank;
  asset.weather = {.dust = Rgb(128, 116, 94), .dust_height_m = 0.6F, .seed = 12};
  return asset;
}

}  // namespace victorious::assets
