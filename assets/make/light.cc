// Lighter vehicles: police car, pickup, excavator.
#include <cmath>
#include <utility>

#include "assets/make/catalogue.h"
#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

// --- Police car ------------------------------------------------------------------------------------------------------

void DecoratePoliceCar(const Canvas& canvas) {
  const Colour blue{136, 66, 30}, yellow{56, 200, 216};
  DrawOnBothSides(canvas, "cabin", [](Stencil& colour, Stencil&) {
    DrawWindow(colour, {{-0.1, 1.0}, {0.82, 1.0}, {0.36, 1.36}, {-0.1, 1.4}});
    DrawWindow(colour, {{-1.25, 1.0}, {-0.2, 1.0}, {-0.2, 1.4}, {-1.0, 1.36}});
  });
  DrawOnBothSides(canvas, "body", [&](Stencil& colour, Stencil& shade) {
    int cell = 0;
    for (double z = -2.2; z < 2.0; z += 0.36, ++cell) {
      colour.Box(z, 0.58, z + 0.36, 0.74, cell % 2 == 0 ? blue : yellow);
      colour.Box(z, 0.74, z + 0.36, 0.9, cell % 2 == 0 ? yellow : blue);
    }
    colour.Box(-0.6, 0.58, 0.7, 0.9, kWhite);
    colour.Text(0.05, 0.74, "POLICE", 0.2, blue);
    DrawDoor(colour, shade, -0.15, 0.36, 0.85, 0.97);
    DrawDoor(colour, shade, -1.2, 0.45, -0.17, 0.97);
  });
  Stencil top = canvas.Colour("cabin", Side::kTop);
  DrawWindow(top, {{1.05, -0.72}, {1.05, 0.72}, {0.38, 0.6}, {0.38, -0.6}});
  DrawWindow(top, {{-1.75, -0.7}, {-1.75, 0.7}, {-1.12, 0.6}, {-1.12, -0.6}});
  top.Text(-0.58, 0.0, "K21", 0.3, kBlack);
  top.Box(-1.05, -0.62, -0.98, 0.62, yellow);
  Stencil ends = canvas.Colour("body", Side::kTop);
  ends.Text(1.65, 0.0, "POLICE", 0.24, blue);
  ends.Fill({{1.2, 0.8}, {2.3, 0.7}, {2.3, 0.5}, {1.2, 0.6}}, blue);
  ends.Fill({{1.2, -0.8}, {2.3, -0.7}, {2.3, -0.5}, {1.2, -0.6}}, blue);
  ends.Hazard(-2.3, -0.75, -1.85, 0.75, yellow, {40, 44, 180}, 0.2);
  Stencil gaps = canvas.Shade("body", Side::kTop);
  gaps.Frame(1.12, -0.78, 2.25, 0.78, kGroove, 0.025);
  gaps.Frame(-2.3, -0.76, -1.78, 0.76, kGroove, 0.025);
  Stencil nose = canvas.Colour("body", Side::kFront);
  DrawHeadlamps(nose, 0.68, 0.66, 0.1);
  nose.Box(-0.45, 0.5, 0.45, 0.66, kBlack);
  Stencil tail = canvas.Colour("body", Side::kBack);
  DrawTailLamps(tail, 0.68, 0.78, 0.3, 0.16);
  tail.Box(-0.26, 0.55, 0.26, 0.66, {120, 200, 210});
}

// --- Pickup ----------------------------------------------------------------------------------------------------------

Mesh PickupBody() {
  const Polygon side = SideOutline({{2.6F, 0.45F},
                                    {2.66F, 0.8F},
                                    {2.56F, 1.06F},
                                    {1.2F, 1.16F},
                                    {-0.4F, 1.14F},
                                    {-0.42F, 0.74F},
                                    {-2.6F, 0.74F},
                                    {-2.62F, 0.5F}},
                                   0.45F, {-1.62F, 1.68F}, 0.42F, 0.5F);
  Mesh body = Extrude(side, Axis::kX, -0.94F, 0.94F, 0.05F);
  const Polygon wall =
      SideOutline({{-0.36F, 0.6F}, {-0.36F, 1.16F}, {-2.64F, 1.16F}, {-2.66F, 0.55F}}, 0.5F, {-1.62F}, 0.42F, 0.5F);
  body.AddBothSides(Extrude(wall, Axis::kX, 0.8F, 0.95F, 0.03F));
  body.Add(Box({0, 0.94F, -2.62F}, {1.8F, 0.48F, 0.1F}, 0.02F))
      .Add(Box({0, 0.94F, -0.42F}, {1.8F, 0.5F, 0.08F}, 0.02F));
  return body.Add(Box({0, 0.58F, 2.7F}, {1.8F, 0.2F, 0.12F}, 0.03F))
      .Add(Box({0, 0.55F, -2.72F}, {1.7F, 0.14F, 0.12F}, 0.03F));
}

Mesh PickupLoad() {
  Mesh load = Box({0.15F, 1.0F, -0.78F}, {1.3F, 0.5F, 0.45F}, 0.03F);
  for (const auto& [x, z] : {std::pair{-0.45F, -1.45F}, {0.12F, -1.5F}}) {
    load.Add(Moved(Revolve({{0, 0.0F},
                            {0, 0.27F},
                            {0.26F, 0.27F},
                            {0.28F, 0.285F},
                            {0.3F, 0.27F},
                            {0.58F, 0.27F},
                            {0.8F, 0.27F},
                            {0.8F, 0.0F}},
                           Axis::kY, 14),
                   At(x, 0.75F, z)));
  }
  load.Add(Moved(Box(Vec3::Zero(), {0.5F, 0.4F, 0.6F}, 0.03F), At(0.5F, 0.98F, -2.1F) * Turn(Axis::kY, 15)));
  return load.Add(Tube({{-0.75F, 1.05F, -2.5F}, {-0.72F, 1.25F, -0.5F}}, 0.05F, 8))
      .Add(Tube({{-0.62F, 1.02F, -2.5F}, {-0.58F, 1.22F, -0.5F}}, 0.05F, 8));
}

void DecoratePickup(const Canvas& canvas) {
  const Colour cream{178, 206, 214};
  DrawOnBothSides(canvas, "cabin", [](Stencil& colour, Stencil&) {
    DrawWindow(colour, {{0.35, 1.2}, {1.22, 1.2}, {0.8, 1.62}, {0.35, 1.64}});
    DrawWindow(colour, {{-0.3, 1.2}, {0.25, 1.2}, {0.25, 1.64}, {-0.22, 1.62}});
  });
  DrawOnBothSides(canvas, "body", [&](Stencil& colour, Stencil& shade) {
    colour.Box(-2.7, 0.72, 2.6, 0.92, cream);
    DrawDoor(colour, shade, 0.3, 0.5, 1.2, 1.14);
    DrawDoor(colour, shade, -0.38, 0.5, 0.28, 1.14);
    shade.Rivets(-2.5, 1.1, -0.5, 1.1, 0.2);
  });
  Stencil top = canvas.Colour("cabin", Side::kTop);
  DrawWindow(top, {{1.4, -0.76}, {1.4, 0.76}, {0.82, 0.66}, {0.82, -0.66}});
  top.Box(-0.1, -0.6, 0.6, -0.46, cream);
  top.Box(-0.1, 0.46, 0.6, 0.6, cream);
  top.Text(0.28, 0.0, "44", 0.5, cream);
  Stencil bed = canvas.Colour("body", Side::kTop);
  for (double x = -0.72; x < 0.75; x += 0.16) bed.Line(-2.55, x, -0.5, x, {54, 60, 64}, 0.06);
  bed.Box(1.5, -0.3, 2.5, -0.2, cream);
  bed.Box(1.5, 0.2, 2.5, 0.3, cream);
  Stencil gaps = canvas.Shade("body", Side::kTop);
  gaps.Frame(1.4, -0.8, 2.52, 0.8, kGroove, 0.03);
  gaps.Grille(1.55, -0.6, 1.75, 0.6, 3, false);
  Stencil nose = canvas.Colour("body", Side::kFront);
  DrawHeadlamps(nose, 0.7, 0.86, 0.12);
  Stencil grille = canvas.Shade("body", Side::kFront);
  grille.Grille(-0.5, 0.75, 0.5, 1.0, 5);
  Stencil tail = canvas.Colour("body", Side::kBack);
  tail.Text(0, 0.95, "FARM 44", 0.22, cream);
  DrawTailLamps(tail, 0.85, 0.95, 0.12, 0.26);
}

// --- Excavator -------------------------------------------------------------------------------------------------------

Mesh ExcavatorTracks() {
  const Polygon loop =
      Rounded({{2.0F, 0.1F}, {2.3F, 0.5F}, {2.0F, 0.92F}, {-2.0F, 0.92F}, {-2.3F, 0.5F}, {-2.0F, 0.1F}}, 0.3F, 3);
  Mesh tracks = Extrude(loop, Axis::kX, 0.95F, 1.6F, 0.04F);
  for (int i = 0; i < 20; ++i) {
    const float z = -1.9F + 0.2F * static_cast<float>(i);
    for (const float y : {0.05F, 0.95F}) tracks.Add(Box({1.28F, y, z}, {0.7F, 0.08F, 0.09F}, 0.01F));
  }
  Mesh both = Mesh().AddBothSides(tracks);
  return both.Add(Box({0, 0.6F, 0}, {2.0F, 0.45F, 1.8F}, 0.08F)).Add(Cylinder({0, 0.7F, 0}, {0, 1.1F, 0}, 0.8F, 18));
}

Mesh ExcavatorHouse() {
  Mesh house = Extrude(
      Rounded({{1.5F, 1.35F}, {1.5F, -1.35F}, {-1.9F, -1.35F}, {-2.5F, -0.8F}, {-2.5F, 0.8F}, {-1.9F, 1.35F}}, 0.3F, 3),
      Axis::kY, 1.05F, 1.75F, 0.06F);
  house.Add(Box({-0.1F, 2.05F, -1.2F}, {2.3F, 0.75F, 1.9F}, 0.12F));
  house.Add(Box({-0.9F, 1.9F, 0.6F}, {0.75F, 0.5F, 1.5F}, 0.08F));
  return house;
}

Mesh ExcavatorBoom() {
  const Polygon boom = {{0.7F, 1.6F},   {2.4F, 3.9F},  {3.0F, 4.25F}, {5.3F, 3.5F},
                        {5.35F, 3.25F}, {2.9F, 3.75F}, {2.6F, 3.6F},  {1.2F, 1.5F}};
  Mesh arm = Extrude(boom, Axis::kX, -0.2F, 0.2F, 0.04F);
  arm.Add(Extrude({{4.75F, 3.85F}, {5.1F, 3.95F}, {5.75F, 1.15F}, {5.5F, 1.1F}, {5.05F, 2.8F}}, Axis::kX, -0.16F, 0.16F,
                  0.03F));
  return arm;
}

Mesh ExcavatorBucket() {
  Mesh bucket = Extrude({{5.65F, 1.35F},
                         {6.05F, 0.95F},
                         {5.95F, 0.3F},
                         {5.35F, 0.05F},
                         {4.85F, 0.25F},
                         {4.95F, 0.35F},
                         {5.35F, 0.2F},
                         {5.75F, 0.45F},
                         {5.8F, 0.85F},
                         {5.5F, 1.2F}},
                        Axis::kX, -0.6F, 0.6F, 0.02F);
  for (const float x : {-0.58F, 0.58F})
    bucket.Add(Extrude({{5.65F, 1.3F}, {5.98F, 0.9F}, {5.9F, 0.32F}, {5.35F, 0.1F}, {4.95F, 0.3F}}, Axis::kX,
                       x - 0.025F, x + 0.025F));
  for (int i = 0; i < 5; ++i)
    bucket.Add(Box({-0.48F + 0.24F * static_cast<float>(i), 0.3F, 4.82F}, {0.1F, 0.08F, 0.26F}, 0.02F));
  return bucket;
}

Mesh ExcavatorRods() {
  Mesh rods = Mesh().AddBothSides(Cylinder({0.32F, 1.5F, 1.4F}, {0.32F, 3.3F, 2.6F}, 0.09F, 10));
  rods.Add(Cylinder({0, 4.3F, 3.1F}, {0, 3.95F, 4.8F}, 0.09F, 10))
      .Add(Cylinder({0, 3.6F, 5.25F}, {0, 1.5F, 5.85F}, 0.08F, 10));
  rods.Add(Tube({{0.12F, 1.9F, 0.8F}, {0.14F, 4.0F, 2.4F}, {0.12F, 4.3F, 3.2F}, {0.1F, 3.7F, 5.0F}}, 0.035F, 6));
  rods.Add(Cylinder({-0.9F, 2.4F, -1.5F}, {-0.9F, 2.95F, -1.5F}, 0.08F, 8))
      .Add(RoofRack(-1.2F, -2.0F, 1.0F, -0.4F, 2.42F, 0.35F));
  return rods;
}

void DecorateExcavator(const Canvas& canvas) {
  const Colour dark{40, 40, 42}, yellow = Pigment(Rgb(214, 160, 38));
  Stencil top = canvas.Shade("house", Side::kTop);
  top.Grille(-1.9, -0.9, -0.5, -0.1, 9, false);
  top.Panel(-2.05, 0.1, -0.35, 0.95);
  top.Panel(0.0, -1.25, 1.3, -0.6);
  for (double z = -0.2; z < 1.4; z += 0.12) top.Line(z, -0.4, z + 0.06, 0.2, Colour{90}, 0.03);
  Stencil top_marks = canvas.Colour("house", Side::kTop);
  top_marks.Hazard(-2.5, -0.85, -2.15, 0.85, yellow, dark, 0.2);
  top_marks.Text(-1.2, 0.55, "X5", 0.4, dark);
  DrawOnBothSides(canvas, "house", [&](Stencil& colour, Stencil& shade) {
    shade.Grille(-0.6, 1.8, -1.9, 2.3, 7);
    shade.Panel(-0.5, 1.15, -1.5, 1.65);
    shade.Panel(0.7, 1.15, -0.4, 1.65);
    colour.Text(-1.9, 1.4, "X5", 0.36, dark);
    colour.Hazard(-2.5, 1.1, -2.1, 1.7, yellow, dark, 0.16);
  });
  DrawOnBothSides(canvas, "boom", [&](Stencil& colour, Stencil& shade) {
    colour.Text(4.0, 3.72, "DIGGER", 0.26, dark);
    shade.Rivets(2.9, 4.1, 5.2, 3.45, 0.2);
    shade.Line(2.4, 3.85, 3.0, 3.7, kGroove, 0.04);
  });
  Stencil back = canvas.Colour("house", Side::kBack);
  back.Hazard(-1.1, 1.15, 1.1, 1.4, yellow, dark, 0.2);
  const Colour frame = Pigment(Rgb(196, 148, 40));
  DrawOnBothSides(canvas, "cab", [&](Stencil& colour, Stencil&) {
    colour.Frame(0.02, 1.8, 1.58, 3.2, frame, 0.16);
    colour.Line(0.75, 1.7, 0.75, 3.2, frame, 0.09);
  });
  Stencil cab_top = canvas.Colour("cab", Side::kTop);
  cab_top.Box(-0.1, 0.3, 1.6, 1.5, frame);
  cab_top.Frame(0.4, 0.6, 1.2, 1.1, dark, 0.08);
}

}  // namespace

Asset PoliceCar() {
  Asset asset{.name = "police_car", .length_m = 4.8F};
  const Polygon lower = SideOutline(Rounded({{2.3F, 0.35F},
                                             {2.38F, 0.62F},
                                             {2.26F, 0.82F},
                                             {1.05F, 0.98F},
                                             {-1.75F, 1.0F},
                                             {-2.36F, 0.94F},
                                             {-2.42F, 0.6F},
                                             {-2.35F, 0.36F}},
                                            0.16F, 3),
                                    0.32F, {-1.4F, 1.45F}, 0.34F, 0.4F);
  asset.Add("body", Extrude(lower, Axis::kX, -0.91F, 0.91F, 0.07F), Coat(Rgb(224, 224, 220), 0.03F));
  const Polygon cabin =
      Rounded({{1.1F, 0.96F}, {0.36F, 1.42F}, {-0.3F, 1.48F}, {-1.1F, 1.44F}, {-1.8F, 0.97F}}, 0.14F, 3);
  asset.Add("cabin", Tapered(Extrude(cabin, Axis::kX, -0.85F, 0.85F, 0.07F), 0.97F, 0.26F),
            Coat(Rgb(224, 224, 220), 0.03F));
  asset.Add("lights", Box({0, 1.53F, 0.02F}, {1.25F, 0.13F, 0.3F}, 0.04F), [](const Surface& s) {
    const float x = s.position.x();
    if (std::abs(x) < 0.14F) return Rgb(206, 206, 200);
    return std::fmod(std::abs(x) + 0.02F, 0.16F) < 0.03F ? Rgb(30, 34, 58)
                                                         : (x > 0 ? Rgb(48, 88, 190) : Rgb(178, 42, 44));
  });
  asset.Add("mirrors", Mirrors(0.88F, 1.0F, 0.8F, 0.14F).Add(Aerial(0.3F, 1.42F, -0.95F, 0.5F)), Coat(Rgb(44, 44, 46)))
      .density = 0.3F;
  AddWheels(asset, {.radius = 0.34F, .width = 0.22F, .x = 0.8F, .z = {1.45F, -1.4F}, .rim = kSteel, .bolts = 5});
  asset.decorate = DecoratePoliceCar;
  asset.weather = {.dust_height_m = 0.22F, .streaks = 0.06F, .stains = 0.05F, .grain = 0.02F, .seed = 22};
  return asset;
}

Asset Pickup() {
  Asset asset{.name = "pickup", .length_m = 5.4F};
  const Paint paint = [](const Surface& s) {
    const float rust = Ramp(Fractal(s.position * 1.5F, 141, 5), 0.2F, 0.34F);
    const float faded = Ramp(s.normal.y(), 0.5F, 1.0F) * Ramp(Fractal(s.position * 1.1F, 145, 3), -0.1F, 0.4F);
    return Mix(Mix(Rgb(112, 58, 44), Rgb(164, 118, 98), 0.6F * faded), Rgb(84, 58, 42), 0.8F * rust);
  };
  asset.Add("body", PickupBody(), paint);
  const Polygon cabin = Rounded({{1.45F, 1.12F}, {0.82F, 1.7F}, {-0.2F, 1.74F}, {-0.38F, 1.1F}}, 0.1F, 2);
  asset.Add("cabin", Tapered(Extrude(cabin, Axis::kX, -0.88F, 0.88F, 0.06F), 1.15F, 0.16F), paint);
  asset.Add("load", PickupLoad(), [](const Surface& s) {
    if (s.position.z() > -1.1F && s.position.x() > -0.6F)
      return Bgr(Rgb(168, 172, 174) * (1 + 0.1F * Noise(s.position * 5, 5)));
    if (s.position.x() < -0.55F && s.position.y() > 1.0F) return Rgb(196, 190, 176);
    if (s.position.z() < -1.8F) return Bgr(Rgb(158, 118, 72) * (1 + 0.2F * Noise(s.position * 8, 6)));
    return s.position.x() > -0.15F ? Rgb(58, 88, 120) : Rgb(176, 128, 44);
  });
  asset
      .Add("gear", Mirrors(0.92F, 1.22F, 1.15F, 0.18F).Add(RoofRack(-0.75F, -0.46F, 0.75F, -0.4F, 1.15F, 0.66F)),
           Coat(Rgb(52, 52, 54)))
      .density = 0.3F;
  AddWheels(asset,
            {.radius = 0.41F, .width = 0.28F, .x = 0.84F, .z = {1.68F, -1.62F}, .rim = Rgb(150, 146, 138), .bolts = 5});
  asset.decorate = DecoratePickup;
  asset.weather = {.dust = Rgb(134, 116, 92),
                   .dust_height_m = 0.45F,
                   .dust_fraction = 0.5F,
                   .streaks = 0.16F,
                   .stains = 0.12F,
                   .seed = 23};
  return asset;
}

Asset Excavator() {
  Asset asset{.name = "excavator", .length_m = 8.6F};
  const Paint yellow = [](const Surface& s) {
    const float chipped = Ramp(Fractal(s.position * 2.4F, 151, 4), 0.26F, 0.36F);
    return Mix(Bgr(Rgb(210, 158, 40) * (1 + 0.08F * Fractal(s.position * 1.2F, 155, 3))), Rgb(92, 74, 56),
               0.8F * chipped);
  };
  asset.Add("house", ExcavatorHouse(), yellow);
  asset.Add("boom", ExcavatorBoom(), yellow);
  asset.Add("cab",
            Extrude(Rounded({{0.0F, 1.75F}, {1.6F, 1.75F}, {1.55F, 2.4F}, {1.2F, 3.2F}, {0.0F, 3.2F}}, 0.1F, 2),
                    Axis::kX, 0.4F, 1.35F, 0.06F),
            Glass(12));
  asset.Add("tracks", ExcavatorTracks(), Coat(Rgb(66, 60, 54), 0.25F)).density = 0.7F;
  asset.Add("bucket", ExcavatorBucket(), Metal(Rgb(108, 98, 86), 7)).density = 0.7F;
  asset.Add("rods", ExcavatorRods(), Metal(Rgb(132, 136, 138), 8)).density = 0.4F;
  asset.decorate = DecorateExcavator;
  asset.weather = {.dust = Rgb(128, 104, 76),
                   .dust_height_m = 0.6F,
                   .dust_fraction = 0.6F,
                   .streaks = 0.2F,
                   .stains = 0.14F,
                   .seed = 24};
  return asset;
}

}  // namespace victorious::assets
