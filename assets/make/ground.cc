#include "assets/make/ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace victorious::assets {
namespace {

using testing::Pencil;

int Wrapped(int cell, int period) { return ((cell % period) + period) % period; }

float Corner(int x, int y, int period, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9E3779B9U + static_cast<std::uint32_t>(Wrapped(x, period)) * 0x85EBCA6BU +
                    static_cast<std::uint32_t>(Wrapped(y, period)) * 0xC2B2AE35U;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  h *= 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<float>(h >> 8) * 0x1.0p-24F;
}

/// Lattice noise with `cells` cells per period, -1 to 1. `u`, `v` in periods.
float Lattice(float u, float v, int cells, std::uint32_t seed) {
  const float x = u * static_cast<float>(cells), y = v * static_cast<float>(cells);
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float tx = x - std::floor(x), ty = y - std::floor(y);
  const float sx = tx * tx * (3 - 2 * tx), sy = ty * ty * (3 - 2 * ty);
  const float top = std::lerp(Corner(x0, y0, cells, seed), Corner(x0 + 1, y0, cells, seed), sx);
  const float bottom = std::lerp(Corner(x0, y0 + 1, cells, seed), Corner(x0 + 1, y0 + 1, cells, seed), sx);
  return 2 * std::lerp(top, bottom, sy) - 1;
}

float Rough(float u, float v, int cells, int octaves, std::uint32_t seed, float gain = 0.55F) {
  float sum = 0;
  float strength = 0.6F;
  for (int i = 0; i < octaves; ++i) {
    sum += strength * Lattice(u, v, cells << i, seed + static_cast<std::uint32_t>(i));
    strength *= gain;
  }
  return sum;
}

/// Random stones: an identifier of the nearest one, 0 to 1, and its distance in cells.
struct Stone {
  float number = 0;
  float distance = 9;
};
Stone Nearest(float u, float v, int cells, std::uint32_t seed) {
  const float x = u * static_cast<float>(cells), y = v * static_cast<float>(cells);
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  Stone nearest;
  for (int i = x0 - 1; i <= x0 + 1; ++i) {
    for (int j = y0 - 1; j <= y0 + 1; ++j) {
      const float dx = static_cast<float>(i) + Corner(i, j, cells, seed) - x;
      const float dy = static_cast<float>(j) + Corner(i, j, cells, seed + 1) - y;
      const float distance = std::sqrt(dx * dx + dy * dy);
      if (distance < nearest.distance) nearest = {Corner(i, j, cells, seed + 2), distance};
    }
  }
  return nearest;
}

/// Bricks of a by b in running bond: an identifier of the brick, and whether the position is in a joint.
struct Bond {
  float number;
  bool joint;
};
Bond RunningBond(float x, float y, float length, float height, float joint, float period_m) {
  const int rows = static_cast<int>(std::lround(period_m / height));
  const int columns = static_cast<int>(std::lround(period_m / length));
  const float v = y / period_m * static_cast<float>(rows);
  const int row = static_cast<int>(std::floor(v));
  const float u = x / period_m * static_cast<float>(columns) + (row % 2 != 0 ? 0.5F : 0.0F);
  const int column = static_cast<int>(std::floor(u));
  const float along = (u - std::floor(u)) * length, across = (v - std::floor(v)) * height;
  const bool in_joint = along < joint || across < joint;
  return {Corner(column, row, columns * rows, 5), in_joint};
}

int Cells(float period_m, float size_m) { return std::max(1, static_cast<int>(std::lround(period_m / size_m))); }

Bgr Tarmac(float x, float y, float period_m, const Bgr& base, std::uint32_t seed) {
  const float u = x / period_m, v = y / period_m;
  const float cloud = Rough(u, v, Cells(period_m, 4), 4, seed);
  const float grit =
      Lattice(u, v, Cells(period_m, 0.09F), seed + 10) + 0.8F * Lattice(u, v, Cells(period_m, 0.04F), seed + 11);
  return base * (1 + 0.30F * cloud + 0.075F * grit);
}

}  // namespace

Bgr Asphalt(float x, float y, float period_m) { return Tarmac(x, y, period_m, Rgb(96, 95, 94), 100); }

Bgr NewAsphalt(float x, float y, float period_m) { return Tarmac(x, y, period_m, Rgb(62, 63, 66), 120); }

Bgr Concrete(float x, float y, float period_m) {
  constexpr float kSlab_m = 4;
  const float u = x / period_m, v = y / period_m;
  const int slabs = Cells(period_m, kSlab_m);
  const float tone = Corner(static_cast<int>(std::floor(u * static_cast<float>(slabs))),
                            static_cast<int>(std::floor(v * static_cast<float>(slabs))), slabs, 140);
  const float across = std::fmod(x, kSlab_m), down = std::fmod(y, kSlab_m);
  const float edge = std::min({across, kSlab_m - across, down, kSlab_m - down});
  if (edge < 0.035F) return Rgb(58, 56, 53);
  const float cloud = Rough(u, v, Cells(period_m, 3), 5, 141, 0.6F);
  const float grit = Lattice(u, v, Cells(period_m, 0.06F), 147);
  const float grime = 0.10F * (1 - Ramp(edge, 0.02F, 0.4F));
  return Rgb(164, 160, 151) * (0.94F + 0.12F * tone + 0.17F * cloud + 0.05F * grit - grime);
}

Bgr Slabs(float x, float y, float period_m) {
  const Bond bond = RunningBond(x, y, 0.6F, 0.6F, 0.035F, period_m);
  const float cloud = Rough(x / period_m, y / period_m, Cells(period_m, 2), 4, 160);
  if (bond.joint) return Rgb(96, 92, 86);
  return Rgb(150, 145, 136) * (0.9F + 0.2F * bond.number + 0.14F * cloud);
}

Bgr Grass(float x, float y, float period_m) {
  const float u = x / period_m, v = y / period_m;
  const float cloud = Rough(u, v, Cells(period_m, 5), 5, 180, 0.6F);
  const float tuft = Rough(u, v, Cells(period_m, 0.5F), 3, 186, 0.75F);
  const float blades = Lattice(u, v, Cells(period_m, 0.06F), 190);
  Bgr green = Mix(Rgb(80, 94, 54), Rgb(118, 120, 76), Ramp(cloud, -0.35F, 0.45F));
  green = Mix(green, Rgb(128, 112, 78), 0.75F * Ramp(Rough(u, v, Cells(period_m, 3), 4, 195), 0.28F, 0.5F));
  return green * (0.98F + 0.3F * tuft + 0.11F * blades);
}

Bgr Meadow(float x, float y, float period_m) {
  const float u = x / period_m, v = y / period_m;
  const float cloud = Rough(u, v, Cells(period_m, 4), 4, 210, 0.6F);
  const Stone tussock = Nearest(u, v, Cells(period_m, 0.8F), 215);
  const float blades = Lattice(u, v, Cells(period_m, 0.08F), 220) + Lattice(u, v, Cells(period_m, 0.2F), 221);
  const Bgr grass =
      Mix(Rgb(88, 100, 58), Rgb(142, 134, 92), Ramp(cloud + 0.35F * (tussock.number - 0.5F), -0.3F, 0.4F));
  return grass * (1.16F - 0.42F * Ramp(tussock.distance, 0.1F, 0.75F) + 0.13F * blades);
}

Bgr Gravel(float x, float y, float period_m) {
  const float u = x / period_m, v = y / period_m;
  const Stone stone = Nearest(u, v, Cells(period_m, 0.12F), 230);
  const Stone rock = Nearest(u, v, Cells(period_m, 0.45F), 236);
  const float cloud = Rough(u, v, Cells(period_m, 4), 4, 240);
  Bgr colour =
      Mix(Rgb(140, 132, 120), Rgb(172, 165, 152), stone.number) * (1.06F - 0.3F * Ramp(stone.distance, 0.25F, 0.7F));
  if (rock.distance < 0.14F + 0.1F * rock.number && rock.number > 0.55F)
    colour = Rgb(186, 182, 172) * (0.7F + 0.4F * rock.number);
  return colour * (0.97F + 0.2F * cloud);
}

Bgr Brick(float x, float y, float period_m) {
  const Bond bond = RunningBond(x, y, 0.4F, 0.2F, 0.03F, period_m);
  const float cloud = Rough(x / period_m, y / period_m, Cells(period_m, 3), 5, 250);
  if (bond.joint) return Rgb(94, 80, 70) * (1 + 0.15F * cloud);
  return Mix(Rgb(126, 84, 68), Rgb(158, 114, 94), bond.number) * (0.98F + 0.22F * cloud);
}

Bgr Dirt(float x, float y, float period_m) {
  const float u = x / period_m, v = y / period_m;
  const float cloud = Rough(u, v, Cells(period_m, 5), 6, 260, 0.62F);
  const float clods = Rough(u, v, Cells(period_m, 0.3F), 3, 270, 0.7F);
  const Bgr soil = Mix(Rgb(108, 86, 62), Rgb(164, 138, 104), Ramp(cloud, -0.4F, 0.4F));
  const float damp = Ramp(Rough(u, v, Cells(period_m, 4), 3, 276), 0.25F, 0.5F);
  return soil * (1 + 0.2F * clods - 0.28F * damp);
}

Ground::Ground(float side_m, int side_px, const Material& base, std::uint64_t seed, bool wraps)
    : side_m_(side_m),
      texels_per_m_(side_px / side_m),
      wraps_(wraps),
      random_(seed),
      image_(side_px, side_px, CV_8UC3) {
  LayBox(base, 0, 0, side_m, side_m);
}

void Ground::Lay(const Material& material, const std::vector<cv::Point2d>& outline) {
  cv::Mat mask(image_.size(), CV_8U, cv::Scalar(0));
  Pencil(mask, {0, 0}, 0, texels_per_m_).Fill(outline, Colour{255});
  oneapi::tbb::parallel_for(0, image_.rows, [&](int y) {
    for (int x = 0; x < image_.cols; ++x) {
      const int share = mask.at<std::uint8_t>(y, x);
      if (share == 0) continue;
      // Four samples per texel, for antialiasing.
      Bgr sum(0, 0, 0);
      for (const auto& [dx, dy] : {std::pair{0.25F, 0.25F}, {0.75F, 0.25F}, {0.25F, 0.75F}, {0.75F, 0.75F}}) {
        const float scale = 1 / static_cast<float>(texels_per_m_);
        sum += material((static_cast<float>(x) + dx) * scale, (static_cast<float>(y) + dy) * scale, side_m_) * 0.25F;
      }
      cv::Vec3b& pixel = image_.at<cv::Vec3b>(y, x);
      pixel = cv::Vec3b(Mix(Bgr(pixel), sum, static_cast<float>(share) / 255));
    }
  });
}

void Ground::LayBox(const Material& material, double x0, double y0, double x1, double y1) {
  constexpr double kOverlap_m = 0.1;  // extends beyond the outer borders, which would else be half covered
  const auto out = [&](double at) { return at <= 0 ? -kOverlap_m : (at >= side_m_ ? at + kOverlap_m : at); };
  Lay(material, {{out(x0), out(y0)}, {out(x1), out(y0)}, {out(x1), out(y1)}, {out(x0), out(y1)}});
}

void Ground::LayDisc(const Material& material, double x, double y, double radius) {
  std::vector<cv::Point2d> outline;
  for (int i = 0; i < 64; ++i) {
    const double angle = i * std::numbers::pi / 32;
    outline.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  Lay(material, outline);
}

void Ground::Draw(const std::function<void(Pencil&)>& draw) {
  const double side_px = image_.cols;
  const int reach = wraps_ ? 1 : 0;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      Pencil pencil(image_, {i * side_px, j * side_px}, 0, texels_per_m_);
      draw(pencil);
    }
  }
}

cv::Mat Ground::Worn(double wear) const {
  cv::Mat kept(image_.size(), CV_32F);
  for (int y = 0; y < kept.rows; ++y) {
    for (int x = 0; x < kept.cols; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(kept.cols);
      const float v = static_cast<float>(y) / static_cast<float>(kept.rows);
      const float chips =
          Rough(u, v, Cells(side_m_, 0.5F), 3, 300, 0.8F) + 0.5F * Rough(u, v, Cells(side_m_, 4), 3, 306);
      kept.at<float>(y, x) =
          0.92F - Ramp(chips, 0.75F - static_cast<float>(wear) * 1.5F, 1.0F - static_cast<float>(wear));
    }
  }
  return cv::max(kept, 0.0F);
}

void Ground::Paint(const Colour& colour, const std::function<void(Pencil&, const Colour&)>& draw, double wear) {
  cv::Mat mask(image_.size(), CV_8U, cv::Scalar(0));
  std::swap(mask, image_);
  Draw([&](Pencil& pencil) { draw(pencil, Colour{255}); });
  std::swap(mask, image_);
  const cv::Mat kept = Worn(wear);
  const Bgr ink(static_cast<float>(colour[0]), static_cast<float>(colour[1]), static_cast<float>(colour[2]));
  for (int y = 0; y < image_.rows; ++y) {
    for (int x = 0; x < image_.cols; ++x) {
      const float share = static_cast<float>(mask.at<std::uint8_t>(y, x)) / 255 * kept.at<float>(y, x);
      cv::Vec3b& pixel = image_.at<cv::Vec3b>(y, x);
      pixel = cv::Vec3b(Mix(Bgr(pixel), ink, share));
    }
  }
}

void Ground::Multiply(const cv::Mat& light) {
  for (int y = 0; y < image_.rows; ++y) {
    for (int x = 0; x < image_.cols; ++x) {
      cv::Vec3b& pixel = image_.at<cv::Vec3b>(y, x);
      pixel = cv::Vec3b(Bgr(pixel) * (static_cast<float>(light.at<std::uint8_t>(y, x)) / 128));
    }
  }
}

std::vector<cv::Point2d> Ground::Wander(cv::Point2d from, double direction, double length_m, double step_m,
                                        double bend) {
  std::vector<cv::Point2d> path = {from};
  for (double gone = 0; gone < length_m; gone += step_m) {
    direction += random_.Normal() * bend;
    path.push_back(path.back() + step_m * cv::Point2d(std::cos(direction), std::sin(direction)));
  }
  return path;
}

void Ground::Cracks(int count, double length_m, const Colour& colour) {
  for (int i = 0; i < count; ++i) {
    const double x = random_.Uniform(0, side_m_), y = random_.Uniform(0, side_m_);
    const double direction = random_.Uniform(0, 2 * std::numbers::pi);
    const double length = length_m * random_.Uniform(0.4, 1.3);
    const auto path = Wander({x, y}, direction, length, 0.25, 0.35);
    std::vector<std::vector<cv::Point2d>> branches = {path};
    for (std::size_t at = 3; at + 1 < path.size(); at += 3) {
      if (random_.Uniform() > 0.35) continue;
      branches.push_back(Wander(path[at], direction + random_.Uniform(-1.6, 1.6), length * 0.3, 0.18, 0.4));
    }
    Draw([&](Pencil& pencil) {
      for (std::size_t branch = 0; branch < branches.size(); ++branch) {
        const auto& line = branches[branch];
        for (std::size_t k = 0; k + 1 < line.size(); ++k)
          pencil.Line(line[k], line[k + 1], colour, branch == 0 ? 0.04 : 0.02);
      }
    });
  }
}

void Ground::TarSeals(int count, double length_m) {
  for (int i = 0; i < count; ++i) {
    const double x = random_.Uniform(0, side_m_), y = random_.Uniform(0, side_m_);
    const double direction = random_.Uniform(0, 2 * std::numbers::pi);
    const auto path = Wander({x, y}, direction, length_m * random_.Uniform(0.5, 1.4), 0.4, 0.22);
    const Colour tar = testing::Shade({42, 41, 40}, random_.Uniform(0.85, 1.15));
    Draw([&](Pencil& pencil) {
      for (std::size_t k = 0; k + 1 < path.size(); ++k) pencil.Line(path[k], path[k + 1], tar, 0.09);
    });
  }
}

void Ground::Patches(int count, const Material& material) {
  for (int i = 0; i < count; ++i) {
    const auto [x, y, w, h, light] =
        testing::Uniforms(random_, {{0, side_m_}, {0, side_m_}, {0.7, 3.5}, {0.5, 2.0}, {0.8, 1.25}});
    const float factor = static_cast<float>(light);
    Lay([&](float px, float py, float period) { return Bgr(material(px + 7, py + 3, period) * factor); },
        {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
    Draw([&, x = x, y = y, w = w, h = h](Pencil& pencil) {
      pencil.Frame(x + w / 2, y + h / 2, w, h, {40, 39, 38}, 0.06);
    });
  }
}

void Ground::Stains(int count, double min_m, double max_m, double light) {
  cv::Mat shade(image_.size(), CV_8U, cv::Scalar(128));
  std::swap(shade, image_);
  for (int i = 0; i < count; ++i) {
    const auto [x, y, size, depth] = testing::Uniforms(random_, {{0, side_m_}, {0, side_m_}, {min_m, max_m}, {0.4, 1}});
    const Colour grey{128 * (1 + (light - 1) * depth)};
    for (int lobe = 0; lobe < 6; ++lobe) {
      const auto [dx, dy, r] = testing::Uniforms(random_, {{-0.6, 0.6}, {-0.6, 0.6}, {0.25, 0.6}});
      Draw([&, x = x, y = y, size = size, dx = dx, dy = dy, r = r](Pencil& pencil) {
        pencil.Disc(x + dx * size, y + dy * size, r * size, grey);
      });
    }
  }
  std::swap(shade, image_);
  cv::GaussianBlur(shade, shade, {}, std::max(1.0, min_m * texels_per_m_ * 0.4));
  Multiply(shade);
}

void Ground::Specks(int count, double min_m, double max_m, const std::vector<Colour>& colours) {
  for (int i = 0; i < count; ++i) {
    const auto [x, y, size, flat, light] =
        testing::Uniforms(random_, {{0, side_m_}, {0, side_m_}, {min_m, max_m}, {0.4, 1}, {0.8, 1.15}});
    const Colour colour = testing::Shade(colours[random_.Below(static_cast<std::uint32_t>(colours.size()))], light);
    Draw([&, x = x, y = y, size = size, flat = flat](Pencil& pencil) {
      pencil.Oval(x, y, size / 2, size / 2 * flat, colour);
    });
  }
}

void Ground::Manhole(double x, double y, double radius) {
  Draw([&](Pencil& pencil) {
    pencil.Disc(x, y, radius * 1.25, {66, 66, 66});
    pencil.Disc(x, y, radius, {98, 104, 108});
    pencil.Ring(x, y, radius * 0.8, {60, 62, 64}, 0.04);
    for (const double at : {-0.4, 0.0, 0.4}) {
      pencil.Line({x - radius * 0.6, y + at * radius}, {x + radius * 0.6, y + at * radius}, {62, 64, 66}, 0.04);
    }
  });
}

void Ground::Drain(double x, double y) {
  Draw([&](Pencil& pencil) {
    pencil.Box(x, y, 0.5, 0.6, {70, 72, 74});
    for (const double at : {-0.2, -0.07, 0.07, 0.2}) pencil.Box(x, y + at, 0.4, 0.06, {28, 28, 28});
  });
}

void Ground::TyreTrack(const std::vector<cv::Point2d>& path, double gauge, double light) {
  cv::Mat shade(image_.size(), CV_8U, cv::Scalar(128));
  std::swap(shade, image_);
  Draw([&](Pencil& pencil) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const cv::Point2d along = path[i + 1] - path[i];
      const cv::Point2d across = cv::Point2d(-along.y, along.x) * (gauge / 2 / cv::norm(along));
      const Colour grey{128 * (i % 2 == 0 ? light : (1 + light) / 2)};
      pencil.Line(path[i] + across, path[i + 1] + across, grey, 0.24);
      pencil.Line(path[i] - across, path[i + 1] - across, grey, 0.24);
    }
  });
  std::swap(shade, image_);
  cv::GaussianBlur(shade, shade, {3, 3}, 0);
  Multiply(shade);
}

void Ground::TyreTracks(int count, double light) {
  for (int i = 0; i < count; ++i) {
    const double x = random_.Uniform(0, side_m_), y = random_.Uniform(0, side_m_);
    const double direction = random_.Uniform(0, 2 * std::numbers::pi);
    TyreTrack(Wander({x, y}, direction, side_m_ * random_.Uniform(0.5, 1.0), 0.22, 0.03), 1.6, light);
  }
}

void Ground::Wear(double x0, double y0, double x1, double y1, double width_m, double light) {
  cv::Mat shade(image_.size(), CV_8U, cv::Scalar(128));
  Pencil(shade, {0, 0}, 0, texels_per_m_).Line({x0, y0}, {x1, y1}, Colour{128 * light}, width_m);
  cv::GaussianBlur(shade, shade, {}, width_m * texels_per_m_ * 0.25);
  Multiply(shade);
}

TexturedMesh GroundTile(const Ground& ground) {
  const float half = ground.side_m() / 2;
  TexturedMesh tile;
  tile.positions = {{half, 0, half}, {-half, 0, half}, {-half, 0, -half}, {half, 0, -half}};
  tile.normals.assign(4, Vec3::UnitY());
  tile.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  tile.indices = {0, 3, 2, 0, 2, 1};
  tile.texture = ground.image();
  tile.jpeg_quality = 80;
  return tile;
}

const std::vector<MaterialEntry>& Materials() {
  constexpr int kSide_px = 1024;
  static const std::vector<Colour> kLitter = {{196, 204, 206}, {92, 132, 164}, {60, 92, 110}, {140, 150, 150}};
  static const std::vector<Colour> kLeaves = {{52, 96, 128}, {60, 120, 150}, {44, 72, 96}};
  static const std::vector<MaterialEntry> kMaterials = {
      {"asphalt",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Asphalt, 1, true);
         ground.Patches(7, NewAsphalt);
         ground.Stains(26, 0.2, 0.9, 0.62);
         ground.Cracks(14, 5, {44, 43, 42});
         ground.TarSeals(6, 5);
         ground.Specks(150, 0.04, 0.14, kLitter);
         ground.Manhole(4.3, 12.8, 0.36);
         return ground;
       }},
      {"concrete",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Concrete, 2, true);
         ground.Stains(24, 0.3, 1.3, 0.7);
         ground.Cracks(10, 4, {92, 96, 98});
         ground.TarSeals(3, 4);
         ground.Specks(110, 0.04, 0.14, {{196, 204, 206}, {70, 80, 86}, {56, 60, 62}});
         return ground;
       }},
      {"grass",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Grass, 3, true);
         ground.Stains(16, 0.4, 1.2, 0.75);
         ground.Specks(180, 0.05, 0.16, {{70, 190, 205}, {205, 215, 215}, {40, 84, 60}, {58, 96, 118}});
         return ground;
       }},
      {"meadow",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Meadow, 4, true);
         ground.TyreTracks(1, 0.78);
         ground.Specks(260, 0.06, 0.22, {{80, 190, 205}, {150, 120, 170}, {36, 70, 52}, {70, 116, 140}});
         return ground;
       }},
      {"gravel",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Gravel, 5, true);
         ground.TyreTracks(3, 0.78);
         ground.Stains(14, 0.4, 1.3, 0.68);
         ground.Specks(70, 0.15, 0.4, {{54, 88, 66}, {62, 100, 80}});
         return ground;
       }},
      {"brick",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Brick, 6, true);
         ground.Stains(22, 0.3, 1.1, 0.72);
         ground.Specks(160, 0.05, 0.14, kLeaves);
         ground.Drain(6.1, 9.4);
         ground.Manhole(14.2, 3.3, 0.33);
         return ground;
       }},
      {"dirt",
       [] {
         Ground ground(kMaterialSide_m, kSide_px, Dirt, 7, true);
         ground.TyreTracks(5, 0.72);
         ground.Stains(10, 0.4, 1.5, 0.66);
         ground.Specks(120, 0.08, 0.3, {{120, 132, 140}, {150, 160, 166}, {58, 90, 70}, {52, 62, 72}});
         return ground;
       }},
  };
  return kMaterials;
}

}  // namespace victorious::assets
