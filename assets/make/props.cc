// tools/: trees, parked cars, and furniture of streets and yards.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "assets/make/fittings.h"
#include "assets/make/town.h"
#include "victorious/base/random.h"

namespace victorious::assets {
namespace {

// --- Trees -----------------------------------------------------------------------------------------------------------

struct TreeStyle {
  std::string name;
  float height = 8;
  float radius = 3;
  float trunk = 2;  ///< m, up to the crown
  int blobs = 9;
  float blob_fraction = 0.5F;  ///< radius of a blob relative to the crown's
  float cone = 0;              ///< 0 round, 1 pointed
  Bgr dark, light;
  std::uint32_t seed = 1;
};

/// A ball of leaves, deformed by noise at two scales.
Mesh LeafBlob(const Vec3& centre, const Vec3& radii, std::uint32_t seed) {
  return Bent(Ball(Vec3::Zero(), Vec3::Ones(), 16), [=](const Vec3& p) {
    const Vec3 out = p.normalized();
    const float swell = 1 + 0.28F * Noise(out * 1.9F, seed) + 0.22F * Noise(out * 4.7F, seed + 1);
    return Vec3(centre + radii.cwiseProduct(out) * swell);
  });
}

Mesh Crown(const TreeStyle& tree) {
  Mesh crown;
  Random random(tree.seed);
  const float deep = tree.height - tree.trunk;
  for (int i = 0; i < tree.blobs; ++i) {
    const float up = (static_cast<float>(i) + 0.5F) / static_cast<float>(tree.blobs);
    const float wide = tree.radius * std::lerp(std::sqrt(std::max(0.05F, 1 - (2 * up - 0.9F) * (2 * up - 0.9F))),
                                               1.0F - 0.9F * up, tree.cone);
    const float size = tree.radius * tree.blob_fraction * std::lerp(1.0F, 1.25F - up, tree.cone) *
                       static_cast<float>(random.Uniform(0.85, 1.15));
    const float angle = static_cast<float>(i) * 2.4F + static_cast<float>(random.Uniform(-0.3, 0.3));
    const float out = std::max(0.0F, wide - size) * static_cast<float>(random.Uniform(0.7, 1.0));
    const Vec3 centre(out * std::cos(angle), tree.trunk + deep * (0.12F + 0.76F * up), out * std::sin(angle));
    crown.Add(LeafBlob(centre, {size, size * 0.85F, size}, tree.seed + static_cast<std::uint32_t>(i) * 5));
  }
  return crown;
}

Asset Tree(const TreeStyle& tree) {
  Asset asset{.name = tree.name, .atlas_px = 512, .jpeg_quality = 82, .corner_shadow = 0.75F};
  asset.weather = {.dust_fraction = 0, .streaks = 0, .stains = 0.1F, .grain = 0.05F};
  Mesh trunk =
      Loft({Section({0, 0, tree.height * 0.045F, tree.height * 0.045F, tree.height * 0.045F}, 8),
            Section({tree.trunk + 1.5F, 0, tree.height * 0.02F, tree.height * 0.02F, tree.height * 0.02F}, 8)});
  asset.Add("trunk", Moved(std::move(trunk), Turn(Axis::kX, -90)), Coat(Rgb(92, 76, 60), 0.2F)).density = 0.4F;
  Part& crown = asset.Add("crown", Crown(tree), [=](const Surface& s) {
    // Clusters of leaves with gaps between, lighter where they stand out.
    const float leaf = Cells(s.position * 3.4F, tree.seed), spray = Cells(s.position * 1.3F, tree.seed + 9);
    const float light = 1.35F - 0.75F * leaf - 0.3F * spray + 0.25F * Fractal(s.position * 0.8F, tree.seed + 20, 3);
    const Bgr green = Mix(tree.dark, tree.light, Ramp(Noise(s.position * 1.1F, tree.seed + 30), -0.6F, 0.7F));
    return Bgr(green * (light * (leaf > 0.62F ? 0.55F : 1.0F)));
  });
  crown.crease_deg = 60;
  return asset;
}

// --- Parked cars -----------------------------------------------------------------------------------------------------

enum class Body { kHatchback, kEstate, kVan };

struct CarStyle {
  std::string name;
  Body body = Body::kHatchback;
  Bgr colour;
  std::uint32_t seed = 1;
};

Polygon CarLower(Body body) {
  if (body == Body::kVan) return {{2.3F, 0.4F}, {2.36F, 0.9F}, {1.55F, 1.2F}, {-2.35F, 1.2F}, {-2.4F, 0.4F}};
  const float rear = body == Body::kEstate ? -2.3F : -2.0F;
  return {{2.05F, 0.35F},        {2.1F, 0.68F},        {1.95F, 0.8F}, {0.95F, 0.95F},
          {rear + 0.05F, 0.98F}, {rear - 0.06F, 0.7F}, {rear, 0.35F}};
}

Polygon CarCabin(Body body) {
  if (body == Body::kVan) return {{1.65F, 1.15F}, {0.95F, 1.9F}, {0.6F, 2.02F}, {-2.3F, 2.02F}, {-2.36F, 1.15F}};
  if (body == Body::kEstate) return {{1.05F, 0.92F}, {0.35F, 1.42F}, {-0.2F, 1.5F}, {-1.75F, 1.46F}, {-2.25F, 0.95F}};
  return {{1.05F, 0.92F}, {0.4F, 1.42F}, {-0.1F, 1.52F}, {-1.2F, 1.48F}, {-1.95F, 0.95F}};
}

Asset Car(const CarStyle& car) {
  Asset asset{.name = car.name, .atlas_px = 512, .jpeg_quality = 82};
  const bool van = car.body == Body::kVan;
  const float half = van ? 0.95F : 0.86F;
  const Polygon lower = SideOutline(Rounded(CarLower(car.body), 0.15F, 2), 0.3F, {-1.3F, 1.3F}, 0.32F, 0.38F);
  asset.Add("body", Extrude(lower, Axis::kX, -half, half, 0.06F), Coat(car.colour, 0.03F));
  asset.Add("cabin",
            Tapered(Extrude(Rounded(CarCabin(car.body), 0.12F, 2), Axis::kX, -half + 0.05F, half - 0.05F, 0.06F), 0.95F,
                    van ? 0.08F : 0.22F),
            Coat(car.colour, 0.03F));
  asset.Add("mirrors", Mirrors(half - 0.02F, van ? 1.3F : 0.98F, 0.75F, 0.14F), Coat(Rgb(40, 40, 42))).density = 0.3F;
  AddWheels(asset, {.radius = 0.32F, .width = 0.2F, .x = half - 0.1F, .z = {1.3F, -1.3F}, .rim = kSteel, .bolts = 5});
  asset.decorate = [=](const Canvas& canvas) {
    const double belt = van ? 1.3 : 1.0, roof = van ? 1.82 : 1.4;
    DrawOnBothSides(canvas, "cabin", [&](Stencil& colour, Stencil&) {
      DrawWindow(colour, {{van ? 0.35 : -0.25, belt},
                          {van ? 1.35 : 0.78, belt},
                          {van ? 0.95 : 0.3, roof - 0.03},
                          {van ? 0.35 : -0.25, roof}});
      if (!van) DrawWindow(colour, {{-1.35, belt}, {-0.35, belt}, {-0.35, roof}, {-1.15, roof - 0.03}});
    });
    DrawOnBothSides(canvas, "body", [&](Stencil& colour, Stencil& shade) {
      DrawDoor(colour, shade, -0.3, 0.38, 0.8, van ? 1.18 : 0.95);
      if (!van) DrawDoor(colour, shade, -1.25, 0.5, -0.32, 0.95);
      shade.Line(-2.2, 0.62, 2.0, 0.6, kGroove, 0.03);
    });
    Stencil top = canvas.Colour("cabin", Side::kTop);
    const double front = van ? 0.98 : 0.42, foot = van ? 1.6 : 1.0, wide = half - 0.14;
    DrawWindow(top, {{foot, -wide}, {foot, wide}, {front, wide - 0.12}, {front, -wide + 0.12}});
    if (!van)
      DrawWindow(top, {{car.body == Body::kEstate ? -2.2 : -1.85, -wide},
                       {car.body == Body::kEstate ? -2.2 : -1.85, wide},
                       {car.body == Body::kEstate ? -1.82 : -1.3, wide - 0.12},
                       {car.body == Body::kEstate ? -1.82 : -1.3, -wide + 0.12}});
    Stencil roof_shade = canvas.Shade("cabin", Side::kTop);
    roof_shade.Frame(van ? -2.2 : -1.1, -wide + 0.1, van ? 0.5 : 0.2, wide - 0.1, Colour{112}, 0.03);
    if (car.seed % 2 == 0) roof_shade.Box(-0.6, -0.4, 0.0, 0.4, Colour{60});
    if (van) {
      for (double z = -1.9; z < 0.4; z += 0.4) roof_shade.Line(z, -0.7, z, 0.7, Colour{108}, 0.04);
    }
    Stencil bonnet = canvas.Shade("body", Side::kTop);
    bonnet.Frame(1.0, -half + 0.15, 1.95, half - 0.15, kGroove, 0.025);
    Stencil nose = canvas.Colour("body", Side::kFront);
    DrawHeadlamps(nose, half - 0.22, van ? 0.8 : 0.66, 0.11);
    nose.Box(-0.45, 0.5, 0.45, 0.62, kBlack);
    Stencil tail = canvas.Colour("body", Side::kBack);
    DrawTailLamps(tail, half - 0.15, 0.78, 0.2, 0.2);
    tail.Box(-0.26, 0.55, 0.26, 0.66, {120, 200, 210});
  };
  asset.weather = {.dust_height_m = 0.25F, .streaks = 0.06F, .stains = 0.06F, .grain = 0.02F, .seed = car.seed};
  return asset;
}

// --- Furniture -------------------------------------------------------------------------------------------------------

Asset Small(std::string name) {
  Asset asset{.name = std::move(name), .atlas_px = 512, .jpeg_quality = 82};
  asset.weather = {.dust_height_m = 0.3F, .streaks = 0.25F, .stains = 0.16F, .seed = 55};
  return asset;
}

Asset Container(const std::string& name, const Bgr& colour, const std::string& label) {
  Asset asset = Small(name);
  asset.Add("box", Box({0, 1.3F, 0}, {2.44F, 2.59F, 6.06F}, 0.05F), [=](const Surface& s) {
    const float along = std::abs(s.normal.z()) > 0.6F ? s.position.x() : s.position.z();
    const float rib = std::fmod(along + 20, 0.28F);
    const float rust = Ramp(Fractal(s.position * 1.1F, 66, 4), 0.16F, 0.42F);
    return Mix(Bgr(colour * (rib < 0.1F ? 0.7F : (rib < 0.16F ? 1.15F : 1.0F))), Rgb(112, 66, 44), 0.6F * rust);
  });
  asset.Add("frame", RoofRack(-1.18F, -2.98F, 1.18F, 2.98F, 0.05F, 2.52F), Coat(colour * 0.7F)).density = 0.3F;
  asset.decorate = [=](const Canvas& canvas) {
    DrawOnBothSides(canvas, "box", [&](Stencil& text, Stencil&) { text.Text(0, 1.5, label, 0.8, kWhite); });
    Stencil roof = canvas.Colour("box", Side::kTop);
    roof.Text(1.6, 0.6, label, 0.5, kWhite);
    roof.Box(-2.8, -1.0, -2.2, 1.0, {60, 180, 205});
    Stencil doors = canvas.Shade("box", Side::kBack);
    for (const double x : {-0.9, -0.35, 0.35, 0.9}) doors.Line(x, 0.1, x, 2.5, kRidge, 0.06);
    doors.Line(0, 0.1, 0, 2.5, kGroove, 0.05);
  };
  return asset;
}

Asset Crates() {
  Asset asset = Small("crates");
  Mesh crates;
  for (const auto& [x, y, z, turn] : {std::tuple{0.0F, 0.5F, 0.0F, 0.0F},
                                      {1.25F, 0.5F, 0.15F, 12.0F},
                                      {0.5F, 1.5F, 0.1F, -18.0F},
                                      {0.3F, 0.5F, 1.3F, 30.0F}}) {
    crates.Add(Moved(Box(Vec3::Zero(), {1, 1, 1}, 0.02F), At(x, y, z) * Turn(Axis::kY, turn)));
  }
  asset.Add("crates", std::move(crates), [](const Surface& s) {
    const float plank = std::fmod(s.position.x() + s.position.z() + 20, 0.2F);
    const float grain = Noise(Vec3(s.position.x() * 9, s.position.y() * 2, s.position.z() * 9), 71);
    return Bgr(Rgb(164, 122, 76) * ((plank < 0.025F ? 0.5F : 1.0F) * (1 + 0.2F * grain)));
  });
  asset.decorate = [](const Canvas& canvas) {
    for (const Side side : {Side::kTop, Side::kLeft, Side::kRight, Side::kFront, Side::kBack}) {
      Stencil wood = canvas.Shade("crates", side);
      wood.Line(-0.5, -0.5, 1.8, 1.8, Colour{84}, 0.1);
      wood.Line(1.8, -0.5, -0.5, 1.8, Colour{84}, 0.1);
      wood.Line(-0.5, 1.0, 1.8, 1.0, Colour{80}, 0.06);
    }
  };
  return asset;
}

Asset Fence() {
  Asset asset = Small("fence");
  Mesh bars = Tube({{0, 1.75F, -3}, {0, 1.75F, 3}}, 0.035F, 6);
  bars.Add(Tube({{0, 0.3F, -3}, {0, 0.3F, 3}}, 0.03F, 6));
  for (int i = 0; i <= 30; ++i) {
    const float z = -3 + 0.2F * static_cast<float>(i);
    const bool post = i % 10 == 0;
    bars.Add(Cylinder({0, 0, z}, {0, post ? 2.0F : 1.85F, z}, post ? 0.06F : 0.018F, post ? 8 : 5));
  }
  asset.Add("bars", std::move(bars), Coat(Rgb(96, 104, 98), 0.15F));
  return asset;
}

Asset Hedge() {
  Asset asset = Small("hedge");
  Mesh hedge;
  for (int i = 0; i < 6; ++i)
    hedge.Add(
        LeafBlob({0, 0.6F, -2.5F + static_cast<float>(i)}, {0.55F, 0.65F, 0.75F}, 80 + static_cast<std::uint32_t>(i)));
  asset.Add("hedge", std::move(hedge), [](const Surface& s) {
    const float leaf = Cells(s.position * 6, 33);
    return Bgr(Mix(Rgb(52, 72, 36), Rgb(98, 112, 58), Ramp(Noise(s.position * 2, 34), -0.5F, 0.6F)) *
               (1.3F - 0.8F * leaf));
  });
  return asset;
}

Asset LampPost() {
  Asset asset = Small("lamp_post");
  Mesh post = Cylinder({0, 0, 0}, {0, 7.5F, 0}, 0.08F, 10);
  post.Add(Cylinder({0, 0, 0}, {0, 1.1F, 0}, 0.13F, 10))
      .Add(Tube({{0, 7.4F, 0}, {0, 7.9F, 0.5F}, {0, 8.0F, 1.6F}}, 0.05F, 8));
  asset.Add("post", std::move(post), Coat(Rgb(128, 132, 132), 0.1F));
  asset.Add("lamp", Box({0, 7.98F, 1.8F}, {0.32F, 0.14F, 0.8F}, 0.05F), Coat(Rgb(86, 90, 92)));
  return asset;
}

Asset Kiosk() {
  Asset asset = Small("bus_stop");
  Mesh frame = Box({0, 2.5F, 0}, {1.7F, 0.14F, 4.2F}, 0.04F);
  for (const float z : {-1.9F, 0.0F, 1.9F}) frame.Add(Cylinder({-0.7F, 0, z}, {-0.7F, 2.5F, z}, 0.05F, 8));
  frame.Add(Box({-0.74F, 1.4F, 0}, {0.05F, 1.8F, 4.0F}, 0.01F))
      .Add(Box({-0.45F, 0.45F, 0}, {0.4F, 0.07F, 3.2F}, 0.02F))
      .Add(Box({0.2F, 1.3F, -2.0F}, {1.3F, 1.9F, 0.14F}, 0.03F));
  asset.Add("frame", std::move(frame), Coat(Rgb(70, 92, 108), 0.1F));
  asset.decorate = [](const Canvas& canvas) {
    Stencil roof = canvas.Colour("frame", Side::kTop);
    roof.Text(0, 0, "BUS", 0.8, kWhite);
    roof.Frame(-1.9, -0.7, 1.9, 0.7, kWhite, 0.06);
  };
  return asset;
}

Asset Skip() {
  Asset asset = Small("skip");
  asset.Add("skip",
            Extrude({{-1.9F, 0.9F}, {-1.2F, 0.15F}, {1.2F, 0.15F}, {1.9F, 0.9F}, {1.75F, 1.35F}, {-1.75F, 1.35F}},
                    Axis::kX, -0.9F, 0.9F, 0.05F),
            Coat(Rgb(186, 148, 52), 0.12F));
  Mesh rubble;
  Random random(4);
  for (int i = 0; i < 22; ++i) {
    const float size = static_cast<float>(random.Uniform(0.2, 0.55));
    const float x = static_cast<float>(random.Uniform(-0.65, 0.65)), z = static_cast<float>(random.Uniform(-1.5, 1.5)),
                turn = static_cast<float>(random.Uniform(0, 90));
    rubble.Add(Moved(Box(Vec3::Zero(), {size, size * 0.6F, size * 1.4F}, 0.03F),
                     At(x, 1.36F, z) * Turn(Axis::kY, turn) * Turn(Axis::kX, turn * 0.4F)));
  }
  asset.Add("rubble", std::move(rubble), [](const Surface& s) {
    return Mix(Rgb(150, 140, 128), Rgb(120, 74, 56), Ramp(Noise(s.position * 2.2F, 9), -0.2F, 0.3F));
  });
  return asset;
}

}  // namespace

const std::vector<Entry>& Props() {
  static const std::vector<Entry> kProps = {
      {"town/trees/oak",
       [] { return Tree({"oak", 9, 4.2F, 2.2F, 11, 0.48F, 0, Rgb(50, 70, 36), Rgb(98, 112, 54), 3}); }},
      {"town/trees/birch",
       [] { return Tree({"birch", 10, 2.4F, 2.4F, 10, 0.55F, 0.15F, Rgb(82, 98, 48), Rgb(142, 144, 78), 14}); }},
      {"town/trees/spruce",
       [] { return Tree({"spruce", 11, 2.6F, 1.0F, 12, 0.62F, 1, Rgb(36, 54, 42), Rgb(66, 86, 62), 25}); }},
      {"town/trees/maple",
       [] { return Tree({"maple", 7, 3.2F, 1.8F, 9, 0.52F, 0, Rgb(104, 62, 38), Rgb(164, 116, 58), 36}); }},
      {"town/cars/hatchback_red", [] { return Car({"hatchback_red", Body::kHatchback, Rgb(152, 40, 38), 1}); }},
      {"town/cars/hatchback_white", [] { return Car({"hatchback_white", Body::kHatchback, Rgb(214, 214, 208), 2}); }},
      {"town/cars/hatchback_green", [] { return Car({"hatchback_green", Body::kHatchback, Rgb(62, 92, 74), 3}); }},
      {"town/cars/estate_blue", [] { return Car({"estate_blue", Body::kEstate, Rgb(58, 82, 122), 4}); }},
      {"town/cars/estate_silver", [] { return Car({"estate_silver", Body::kEstate, Rgb(168, 172, 176), 5}); }},
      {"town/cars/estate_black", [] { return Car({"estate_black", Body::kEstate, Rgb(44, 45, 48), 6}); }},
      {"town/cars/van_white", [] { return Car({"van_white", Body::kVan, Rgb(220, 220, 214), 7}); }},
      {"town/cars/van_yellow", [] { return Car({"van_yellow", Body::kVan, Rgb(204, 162, 56), 8}); }},
      {"town/props/container_red", [] { return Container("container_red", Rgb(142, 62, 50), "PORT A"); }},
      {"town/props/container_blue", [] { return Container("container_blue", Rgb(58, 88, 124), "PORT B"); }},
      {"town/props/crates", Crates},
      {"town/props/fence", Fence},
      {"town/props/hedge", Hedge},
      {"town/props/lamp_post", LampPost},
      {"town/props/bus_stop", Kiosk},
      {"town/props/skip", Skip},
  };
  return kProps;
}

}  // namespace victorious::assets
