// tools/: the buildings of the town. Their fronts face +z.
#include "assets/make/town.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "assets/make/fittings.h"

namespace victorious::assets {
namespace {

constexpr float kParapet_m = 0.7F;

/// Rows of windows on a wall: `b0` is the first sill, `rise` the storeys' height.
struct WindowRows {
  double a0 = 0, a1 = 1;  ///< the wall's ends
  double b0 = 1;
  double rise = 3;
  int storeys = 1;
  double width = 1.2, height = 1.5;
  double step = 2.2;
  bool sills = true;
};

void DrawWindows(Stencil& colour, const WindowRows& rows, const Colour& frame, Random& random) {
  const int count = std::max(1, static_cast<int>((rows.a1 - rows.a0) / rows.step));
  const double step = (rows.a1 - rows.a0) / count;
  for (int storey = 0; storey < rows.storeys; ++storey) {
    for (int i = 0; i < count; ++i) {
      const double a = rows.a0 + (i + 0.5) * step, b = rows.b0 + storey * rows.rise;
      const double w = rows.width / 2;
      colour.Box(a - w - 0.08, b - 0.08, a + w + 0.08, b + rows.height + 0.08, frame);
      colour.Box(a - w, b, a + w, b + rows.height, testing::Shade({66, 56, 48}, random.Uniform(0.7, 1.3)));
      if (random.Uniform() < 0.4)
        colour.Box(a - w, b + rows.height * random.Uniform(0.3, 0.8), a + w, b + rows.height, {170, 178, 184});
      colour.Box(a - w, b, a + w, b + rows.height * 0.3, {92, 84, 74});
      colour.Line(a, b, a, b + rows.height, frame, 0.06);
      if (rows.sills) colour.Box(a - w - 0.15, b - 0.18, a + w + 0.15, b - 0.06, {176, 180, 182});
    }
  }
}

Mesh Parapet(float half_x, float half_z, float height) {
  Mesh mesh;
  const float y = height + kParapet_m / 2;
  for (const float s : {-1.0F, 1.0F}) {
    mesh.Add(Box({s * (half_x - 0.15F), y, 0}, {0.34F, kParapet_m, 2 * half_z}, 0.04F));
    mesh.Add(Box({0, y, s * (half_z - 0.15F)}, {2 * half_x, kParapet_m, 0.34F}, 0.04F));
  }
  return mesh;
}

Mesh AirHandler(float x, float z, float y, float size) {
  Mesh unit = Box({x, y + 0.45F * size, z}, {1.6F * size, 0.9F * size, 1.2F * size}, 0.06F);
  unit.Add(Cylinder({x - 0.35F * size, y + 0.88F * size, z}, {x - 0.35F * size, y + 1.0F * size, z}, 0.3F * size, 12));
  return unit.Add(
      Cylinder({x + 0.4F * size, y + 0.88F * size, z}, {x + 0.4F * size, y + 1.0F * size, z}, 0.3F * size, 12));
}

Mesh Vent(float x, float z, float y) {
  Mesh vent = Cylinder({x, y, z}, {x, y + 0.7F, z}, 0.16F, 8);
  return vent.Add(
      Moved(Revolve({{0, 0.0F}, {0, 0.3F}, {0.2F, 0.1F}, {0.22F, 0.0F}}, Axis::kY, 10), At(x, y + 0.68F, z)));
}

Mesh Mast(float x, float z, float y, float height) {
  Mesh mast = Cylinder({x, y, z}, {x, y + height, z}, 0.05F, 6);
  for (int i = 1; i <= 4; ++i) {
    const float at = y + height * (0.5F + 0.12F * static_cast<float>(i));
    mast.Add(Cylinder({x - 0.6F, at, z}, {x + 0.6F, at, z}, 0.025F, 5));
  }
  return mast;
}

Mesh Dish(float x, float z, float y) {
  Mesh dish = Moved(
      Revolve({{0, 0.0F}, {0.05F, 0.3F}, {0.22F, 0.62F}, {0.25F, 0.62F}, {0.1F, 0.28F}, {0.06F, 0.0F}}, Axis::kZ, 14),
      At(x, y + 0.9F, z) * Turn(Axis::kX, -35));
  return dish.Add(Cylinder({x, y, z}, {x, y + 0.9F, z}, 0.05F, 6));
}

/// Roofing felt in strips with seams, pools and mended places.
Paint FlatRoof(const Bgr& colour, std::uint32_t seed) {
  return [=](const Surface& s) {
    const Vec3& p = s.position;
    const float seam = std::fmod(p.x() + 100, 1.0F);
    const float cloud = Fractal(p * 0.5F, seed, 4);
    const float pool = Ramp(Fractal(p * 0.35F, seed + 9, 3), 0.12F, 0.3F);
    Bgr felt = colour * (1 + 0.25F * cloud + 0.06F * Noise(p * 12, seed + 4)) * (1 - 0.25F * pool);
    if (s.normal.y() > 0.8F && seam < 0.06F) felt *= 0.72F;
    return felt;
  };
}

Paint Tiles(const Bgr& colour, bool ridge_along_z, std::uint32_t seed) {
  return [=](const Surface& s) {
    const float along = ridge_along_z ? s.position.z() : s.position.x();
    const float course = s.position.y() * 4.6F, column = along * 3.6F;
    const float row = std::floor(course);
    const float shift = column + (static_cast<int>(row) % 2 == 0 ? 0.5F : 0.0F);
    const float own = Noise(Vec3(std::floor(shift) * 1.7F + 0.5F, row * 1.3F + 0.5F, 0.5F), seed);
    const float edge = course - row < 0.22F || shift - std::floor(shift) < 0.12F ? 0.66F : 1.0F;
    const float moss = Ramp(Fractal(s.position * 0.6F, seed + 3, 4), 0.12F, 0.42F);
    return Mix(Bgr(colour * (1 + 0.24F * own)), Rgb(92, 96, 72), 0.55F * moss) * edge;
  };
}

Paint BrickWall(const Bgr& colour, std::uint32_t seed) {
  return [=](const Surface& s) {
    const float along = std::abs(s.normal.x()) > 0.5F ? s.position.z() : s.position.x();
    const float course = s.position.y() * 6, row = std::floor(course);
    const float column = along * 3 + (static_cast<int>(row) % 2 == 0 ? 0.5F : 0.0F);
    const float own = Noise(Vec3(std::floor(column) * 1.7F + 0.5F, row * 1.3F + 0.5F, 0.5F), seed);
    const bool joint = course - row < 0.16F || column - std::floor(column) < 0.08F;
    return Bgr(colour * (joint ? 1.12F : 1 + 0.16F * own) * (1 + 0.14F * Fractal(s.position * 0.7F, seed + 2, 3)));
  };
}

Paint Render(const Bgr& colour, std::uint32_t seed) {
  return [=](const Surface& s) {
    return Bgr(colour * (1 + 0.13F * Fractal(s.position.cwiseProduct(Vec3(0.9F, 0.3F, 0.9F)), seed, 4)));
  };
}

/// Sheet metal: ribs across `axis`, panels of differing tone, rust.
Paint Ribbed(const Bgr& colour, bool ribs_along_x, std::uint32_t seed) {
  return [=](const Surface& s) {
    const float across = ribs_along_x ? s.position.z() : s.position.x();
    const float rib = std::fmod(across + 200, 0.5F);
    const float sheet = Noise(Vec3(std::floor(across / 3) * 1.7F + 0.5F, 0.5F, 0.5F), seed);
    const float rust = Ramp(Fractal(s.position * 0.5F, seed + 4, 5), 0.2F, 0.45F);
    const Bgr tin = colour * (1 + 0.14F * sheet) * (rib < 0.1F ? 0.74F : (rib < 0.17F ? 1.12F : 1.0F));
    return Mix(tin, Rgb(120, 78, 54), 0.6F * rust);
  };
}

Asset Building(std::string name) {
  Asset asset{.name = std::move(name)};
  asset.weather = {.dust = Rgb(110, 104, 94),
                   .dust_height_m = 0.8F,
                   .dust_fraction = 0.3F,
                   .streaks = 0.2F,
                   .stains = 0.12F,
                   .seed = 31};
  asset.jpeg_quality = 82;
  return asset;
}

/// A block with a flat roof and its roof structures.
struct Block {
  std::string name;
  float half_x, half_z, height;
  Paint wall;
  Bgr roof;
  std::uint32_t seed;
};

Asset FlatBlock(const Block& block, Mesh on_roof) {
  Asset asset = Building(block.name);
  asset
      .Add("walls", Box({0, block.height / 2, 0}, {2 * block.half_x, block.height, 2 * block.half_z}, 0.02F),
           block.wall)
      .share_sides = true;
  asset.Add("parapet", Parapet(block.half_x, block.half_z, block.height), Coat(Rgb(176, 172, 162), 0.08F)).density =
      0.5F;
  // The roof is a separate part, so that it has its own paint.
  asset
      .Add("roof", Box({0, block.height + 0.03F, 0}, {2 * block.half_x - 0.1F, 0.06F, 2 * block.half_z - 0.1F}, 0.01F),
           FlatRoof(block.roof, block.seed))
      .density = 1.5F;
  asset.Add("fittings", std::move(on_roof), Metal(Rgb(158, 160, 160), block.seed)).density = 0.8F;
  return asset;
}

void DrawRoofWalk(const Canvas& canvas, float half_x, float half_z) {
  Stencil roof = canvas.Shade("roof", Side::kTop);
  roof.Box(-half_z + 1.0, -0.4, half_z - 1.0, 0.1, Colour{152});
  for (double z = -half_z + 1; z < half_z - 1; z += 0.6) roof.Line(z, -0.4, z, 0.1, kGroove, 0.03);
  roof.Path({{-half_z + 0.8, half_x - 1.2}, {half_z * 0.3, half_x - 1.2}, {half_z * 0.3, -half_x + 1}}, kGroove, 0.12);
  for (const double s : {-0.7, 0.7}) roof.Disc(s * half_z, -s * half_x, 0.2, kSoot);
}

Asset Offices() {
  Mesh top = AirHandler(2.5F, -3, 12.1F, 1.6F);
  top.Add(AirHandler(-3, -4, 12.1F, 1.3F))
      .Add(Box({-2.5F, 13.3F, 3.5F}, {3.2F, 2.4F, 3.6F}, 0.05F))
      .Add(Mast(-3.5F, 4.5F, 14.4F, 3.5F))
      .Add(Dish(4.5F, 5, 12.1F));
  for (const float z : {1.0F, 4.0F, 7.0F}) top.Add(Vent(5.2F, z, 12.1F));
  top.Add(Tube({{5.5F, 12.4F, -8}, {0.5F, 12.4F, -8}, {0.5F, 12.4F, 6}}, 0.14F, 6));
  Asset asset =
      FlatBlock({"offices", 7, 10, 12, Render(Rgb(186, 180, 166), 41), Rgb(120, 116, 110), 42}, std::move(top));
  asset.decorate = [](const Canvas& canvas) {
    Random random(5);
    for (const auto& [side, half] : {std::pair{Side::kLeft, 10.0}, {Side::kFront, 7.0}}) {
      Stencil wall = canvas.Colour("walls", side);
      for (int i = 0; i < 4; ++i) wall.Box(-half, 0.9 + i * 3, half, 2.6 + i * 3, {92, 88, 82});
      DrawWindows(wall, {-half + 0.3, half - 0.3, 1.0, 3, 4, 1.5, 1.5, 1.8, false}, {120, 122, 122}, random);
    }
    DrawRoofWalk(canvas, 7, 10);
    Stencil roof = canvas.Colour("roof", Side::kTop);
    roof.Ring(-4.5, 2.5, 2.0, {70, 170, 205}, 0.2);
  };
  return asset;
}

Asset Flats() {
  Mesh top = Box({0, 16.3F, -4}, {3, 2.6F, 3}, 0.05F);
  top.Add(Box({0, 16.3F, 6}, {3, 2.6F, 3}, 0.05F))
      .Add(Mast(1, -4, 17.6F, 3))
      .Add(Dish(-3, 1, 15.1F))
      .Add(Dish(3.2F, -8, 15.1F))
      .Add(Dish(-3.4F, 8.5F, 15.1F));
  for (const float z : {-9.0F, -1.0F, 2.0F, 9.0F}) top.Add(Vent(-2.0F, z, 15.1F)).Add(Vent(3.6F, z + 1, 15.1F));
  Asset asset =
      FlatBlock({"flats", 5.5F, 12, 15, BrickWall(Rgb(150, 104, 82), 45), Rgb(140, 134, 124), 46}, std::move(top));
  Mesh balconies;
  for (int storey = 1; storey < 5; ++storey) {
    for (const float z : {-8.0F, -3.0F, 3.0F, 8.0F})
      balconies.AddBothSides(Box({6.1F, 3.0F * static_cast<float>(storey) + 0.4F, z}, {1.3F, 1.0F, 2.6F}, 0.03F));
  }
  asset.Add("balconies", std::move(balconies), Coat(Rgb(196, 190, 178))).density = 0.4F;
  asset.decorate = [](const Canvas& canvas) {
    Random random(6);
    Stencil side = canvas.Colour("walls", Side::kLeft);
    DrawWindows(side, {-11.6, 11.6, 1.0, 3, 5, 1.3, 1.5, 2.4}, {196, 200, 202}, random);
    Stencil front = canvas.Colour("walls", Side::kFront);
    DrawWindows(front, {-5, 5, 1.0, 3, 5, 1.1, 1.4, 2.5}, {196, 200, 202}, random);
    DrawRoofWalk(canvas, 5.5F, 12);
  };
  return asset;
}

Asset Shop() {
  Mesh top = AirHandler(-2, -2, 4.6F, 1.2F);
  top.Add(AirHandler(3.5F, 1, 4.6F, 1.0F)).Add(Vent(5, -4, 4.6F)).Add(Vent(4.2F, -4, 4.6F));
  for (const float x : {-5.0F, -2.0F, 1.0F}) top.Add(Box({x, 4.85F, 3.0F}, {1.6F, 0.5F, 1.2F}, 0.12F));
  Asset asset = FlatBlock({"shop", 8, 6, 4.5F, Render(Rgb(204, 196, 176), 51), Rgb(96, 96, 98), 52}, std::move(top));
  asset.Add("awning", Extrude({{6.0F, 3.3F}, {7.4F, 2.7F}, {7.4F, 2.6F}, {6.0F, 3.1F}}, Axis::kX, -7.5F, 7.5F),
            [](const Surface& s) {
              return std::fmod(s.position.x() + 20, 1.2F) < 0.6F ? Rgb(174, 62, 54) : Rgb(222, 216, 204);
            });
  asset.decorate = [](const Canvas& canvas) {
    Random random(7);
    Stencil front = canvas.Colour("walls", Side::kFront);
    DrawWindows(front, {-7.5, 7.5, 0.4, 3, 1, 2.1, 2.0, 2.5, false}, {60, 62, 64}, random);
    Stencil side = canvas.Colour("walls", Side::kLeft);
    DrawWindows(side, {-5.5, 5.5, 1.6, 3, 1, 1.0, 0.9, 2.6}, {190, 194, 196}, random);
    DrawRoofWalk(canvas, 8, 6);
    Stencil roof = canvas.Colour("roof", Side::kTop);
    roof.Text(-3.6, -4.4, "SHOP", 1.4, {190, 196, 198});
  };
  return asset;
}

/// A house of one or two storeys under a gabled roof; the ridge runs along z.
struct House {
  std::string name;
  float half_x, half_z, eaves, ridge;
  Paint wall;
  Bgr tiles;
  std::uint32_t seed;
};

Asset GabledHouse(const House& house) {
  Asset asset = Building(house.name);
  const float x = house.half_x, z = house.half_z;
  Mesh walls =
      Extrude({{-x, 0}, {x, 0}, {x, house.eaves}, {0, house.ridge - 0.1F}, {-x, house.eaves}}, Axis::kZ, -z, z);
  asset.Add("walls", std::move(walls), house.wall).share_sides = true;
  const float slope = (house.ridge - house.eaves) / x, out = 0.55F, thick = 0.22F;
  const Polygon slopes = {{-x - out, house.eaves - slope * out}, {0, house.ridge},
                          {x + out, house.eaves - slope * out},  {x + out, house.eaves - slope * out + thick},
                          {0, house.ridge + thick * 1.2F},       {-x - out, house.eaves - slope * out + thick}};
  asset.Add("roof", Extrude(slopes, Axis::kZ, -z - 0.45F, z + 0.45F), Tiles(house.tiles, true, house.seed)).density =
      1.4F;
  Mesh fittings = Box({x * 0.4F, house.ridge, -z * 0.45F}, {0.7F, 1.9F, 0.9F}, 0.04F);
  fittings.Add(
      Cylinder({x * 0.4F, house.ridge + 0.9F, -z * 0.45F}, {x * 0.4F, house.ridge + 1.3F, -z * 0.45F}, 0.16F, 8));
  fittings.Add(Mast(-x * 0.1F, z * 0.6F, house.ridge - 0.2F, 2.2F))
      .Add(Tube({{0, house.ridge + 0.2F, -z - 0.4F}, {0, house.ridge + 0.2F, z + 0.4F}}, 0.12F, 6));
  for (const float s : {-1.0F, 1.0F})
    fittings.Add(Cylinder({s * (x + out), house.eaves - slope * out, -z - 0.4F},
                          {s * (x + out), house.eaves - slope * out, z + 0.4F}, 0.09F, 6));
  asset.Add("fittings", std::move(fittings), BrickWall(Rgb(132, 92, 76), house.seed + 1)).density = 0.7F;
  asset.decorate = [=](const Canvas& canvas) {
    Random random(house.seed);
    const int storeys = house.eaves > 4 ? 2 : 1;
    Stencil side = canvas.Colour("walls", Side::kLeft);
    DrawWindows(side, {-z + 0.4, z - 0.4, 1.0, 2.8, storeys, 1.2, 1.3, 2.6}, {208, 212, 214}, random);
    Stencil front = canvas.Colour("walls", Side::kFront);
    DrawWindows(front, {-x + 0.4, x - 0.4, 1.0, 2.8, storeys, 1.1, 1.3, 2.6}, {208, 212, 214}, random);
    front.Box(-0.55, 0, 0.55, 2.15, {56, 72, 110});
    Stencil roof = canvas.Colour("roof", Side::kTop);
    const auto skylight = [&](double at, double across) {
      roof.Box(at - 0.6, across - 0.5, at + 0.6, across + 0.5, {70, 74, 78});
      roof.Box(at - 0.48, across - 0.38, at + 0.48, across + 0.38, {128, 110, 90});
      roof.Box(at - 0.48, across - 0.38, at + 0.1, across + 0.1, {168, 152, 134});
    };
    skylight(-z * 0.3, x * 0.5);
    skylight(z * 0.35, -x * 0.45);
    if (house.seed % 2 == 0) {  // solar cells
      for (int i = 0; i < 6; ++i) {
        const double at = -z * 0.1 + 1.1 * (i % 3), across = x * 0.35 + 1.7 * (i / 3 - 0.5);
        roof.Box(at, across - 0.8, at + 1.0, across + 0.8, {72, 50, 36});
        roof.Frame(at, across - 0.8, at + 1.0, across + 0.8, {170, 168, 164}, 0.05);
        roof.Line(at, across, at + 1.0, across, {150, 140, 130}, 0.03);
      }
    }
  };
  return asset;
}

/// A hall under a low roof of ribbed sheet.
Asset Warehouse() {
  Asset asset = Building("warehouse");
  asset
      .Add("walls", Extrude({{-9, 0}, {9, 0}, {9, 6}, {0, 7.6F}, {-9, 6}}, Axis::kZ, -14, 14),
           Ribbed(Rgb(150, 162, 168), true, 61))
      .share_sides = true;
  asset
      .Add("roof",
           Extrude({{-9.3F, 5.95F}, {0, 7.6F}, {9.3F, 5.95F}, {9.3F, 6.15F}, {0, 7.85F}, {-9.3F, 6.15F}}, Axis::kZ,
                   -14.2F, 14.2F),
           Ribbed(Rgb(138, 146, 150), true, 62))
      .density = 1.4F;
  Mesh fittings;
  for (int i = 0; i < 5; ++i) {
    const float z = -11 + 5.4F * static_cast<float>(i);
    fittings.Add(
        Moved(Revolve({{0, 0.0F}, {0, 0.35F}, {0.4F, 0.35F}, {0.55F, 0.55F}, {0.8F, 0.4F}, {0.9F, 0.0F}}, Axis::kY, 14),
              At(0, 7.75F, z)));
  }
  fittings.Add(Box({5, 7.1F, -9}, {2.2F, 1.2F, 1.8F}, 0.06F))
      .Add(Tube({{5, 7.4F, -8}, {5, 7.4F, -2}, {2, 7.9F, -2}}, 0.25F, 8));
  asset.Add("fittings", std::move(fittings), Metal(Rgb(170, 172, 170), 63)).density = 0.7F;
  asset.decorate = [](const Canvas& canvas) {
    Stencil roof = canvas.Colour("roof", Side::kTop);
    for (const double s : {-1.0, 1.0}) {
      for (double z = -11.5; z < 12; z += 5) {
        roof.Box(z, s * 3.0, z + 1.1, s * 7.4, {178, 186, 186});
        for (double x = 3.4; x < 7.4; x += 0.5) roof.Line(z, s * x, z + 1.1, s * x, {140, 148, 150}, 0.05);
      }
    }
    roof.Text(1.6, 5.4, "D 4", 2.4, {86, 84, 80});
    Stencil front = canvas.Colour("walls", Side::kFront);
    for (const double x : {-5.0, 0.5, 6.0}) {
      front.Box(x - 2, 0, x + 2, 4.2, {110, 104, 96});
      for (double y = 0.4; y < 4.2; y += 0.4) front.Line(x - 2, y, x + 2, y, {84, 80, 74}, 0.06);
      front.Hazard(x - 2.3, 0, x - 2.05, 2, {60, 190, 215}, {40, 40, 40}, 0.25);
    }
    Stencil side = canvas.Colour("walls", Side::kLeft);
    for (double z = -12; z < 12; z += 4) side.Box(z, 4.2, z + 2.8, 5.2, {96, 88, 78});
  };
  return asset;
}

Asset Garages() {
  Asset asset = Building("garages");
  asset.Add("walls", Box({0, 1.3F, 0}, {16, 2.6F, 5.6F}, 0.02F), Render(Rgb(168, 162, 150), 71)).share_sides = true;
  asset
      .Add("roof", Extrude({{-2.95F, 2.6F}, {2.95F, 2.75F}, {2.95F, 2.95F}, {-2.95F, 2.8F}}, Axis::kX, -8.2F, 8.2F),
           Ribbed(Rgb(128, 122, 116), false, 72))
      .density = 1.3F;
  asset.decorate = [](const Canvas& canvas) {
    Stencil front = canvas.Colour("walls", Side::kFront);
    const Colour kDoors[] = {{92, 104, 66}, {86, 76, 120}, {150, 150, 146}, {120, 92, 70}, {80, 110, 128}};
    for (int i = 0; i < 5; ++i) {
      const double x = -6.4 + 3.2 * i;
      front.Box(x - 1.3, 0, x + 1.3, 2.2, kDoors[i]);
      for (double y = 0.3; y < 2.2; y += 0.3) front.Line(x - 1.3, y, x + 1.3, y, testing::Shade(kDoors[i], 0.75), 0.04);
    }
    Stencil roof = canvas.Colour("roof", Side::kTop);
    for (int i = 0; i < 5; ++i) roof.Text(0.6, -6.4 + 3.2 * i, std::to_string(i + 1), 1.0, {188, 192, 194});
  };
  return asset;
}

Asset Tower() {  // a water tower
  Asset asset = Building("water_tower");
  asset.Add(
      "tank",
      Moved(Revolve({{0, 0.0F}, {0.6F, 2.2F}, {1.4F, 3.1F}, {4.2F, 3.1F}, {5.1F, 1.6F}, {5.5F, 0.3F}, {5.6F, 0.0F}},
                    Axis::kY, 28),
            At(0, 11, 0)),
      [](const Surface& s) {
        const float angle = std::atan2(s.position.x(), s.position.z()) * 6.366F;
        const Bgr sheet = std::fmod(angle + 40, 2.0F) < 0.06F || std::fmod(s.position.y(), 1.4F) < 0.05F
                              ? Rgb(120, 126, 130)
                              : Rgb(186, 194, 196);
        const float rust = Ramp(Fractal(s.position.cwiseProduct(Vec3(0.9F, 0.25F, 0.9F)), 81, 4), 0.15F, 0.45F);
        return Mix(sheet, Rgb(132, 84, 58), 0.6F * rust);
      });
  Mesh legs = Cylinder({0, 0, 0}, {0, 12, 0}, 0.5F, 12);
  for (int i = 0; i < 6; ++i) {
    const float a = static_cast<float>(i) * 1.0472F;
    const Vec3 foot(3.6F * std::cos(a), 0, 3.6F * std::sin(a)), head(2.6F * std::cos(a), 12.2F, 2.6F * std::sin(a));
    legs.Add(Cylinder(foot, head, 0.18F, 8));
    const float b = a + 1.0472F;
    legs.Add(
        Cylinder({3.3F * std::cos(a), 4, 3.3F * std::sin(a)}, {3.3F * std::cos(b), 4, 3.3F * std::sin(b)}, 0.09F, 6));
    legs.Add(Cylinder({2.95F * std::cos(a), 8, 2.95F * std::sin(a)}, {2.95F * std::cos(b), 8, 2.95F * std::sin(b)},
                      0.09F, 6));
  }
  legs.Add(Ladder({3.0F, 0, 0.8F}, {3.2F, 15.2F, 0.8F}, 0.5F, 0.5F));
  asset.Add("legs", std::move(legs), Coat(Rgb(120, 112, 104), 0.15F)).density = 0.4F;
  asset
      .Add("walk", Moved(Revolve({{0, 3.0F}, {0, 3.9F}, {0.1F, 3.9F}, {0.1F, 3.0F}}, Axis::kY, 28), At(0, 12.4F, 0)),
           Metal(Rgb(110, 112, 112)))
      .density = 0.5F;
  asset.decorate = [](const Canvas& canvas) {
    DrawOnBothSides(canvas, "tank",
                    [](Stencil& colour, Stencil&) { colour.Text(0, 13.8, "AQUA", 1.4, {110, 66, 44}); });
    Stencil top = canvas.Colour("tank", Side::kTop);
    top.Ring(0, 0, 0.8, {90, 92, 94}, 0.15);
    top.Box(0.8, 1.2, 1.8, 2.0, {84, 86, 88});
  };
  return asset;
}

}  // namespace

const std::vector<Entry>& Buildings() {
  static const std::vector<Entry> kBuildings = {
      {"town/buildings/offices", Offices},
      {"town/buildings/flats", Flats},
      {"town/buildings/shop", Shop},
      {"town/buildings/warehouse", Warehouse},
      {"town/buildings/garages", Garages},
      {"town/buildings/water_tower", Tower},
      {"town/buildings/house_red",
       [] {
         return GabledHouse({"house_red", 4.5F, 6, 5.6F, 9, Render(Rgb(206, 196, 172), 90), Rgb(146, 84, 62), 90});
       }},
      {"town/buildings/house_grey",
       [] {
         return GabledHouse({"house_grey", 4, 5, 2.9F, 6, BrickWall(Rgb(156, 108, 84), 91), Rgb(96, 98, 102), 91});
       }},
      {"town/buildings/house_brown",
       [] {
         return GabledHouse(
             {"house_brown", 4.2F, 8, 5.4F, 8.6F, BrickWall(Rgb(176, 150, 118), 94), Rgb(112, 82, 66), 94});
       }},
  };
  return kBuildings;
}

}  // namespace victorious::assets
