#include "assets/make/paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace victorious::assets {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A hash of a cell's position, in [0, 1).
float CellValue(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9E3779B9U + static_cast<std::uint32_t>(x) * 0x85EBCA6BU +
                    static_cast<std::uint32_t>(y) * 0xC2B2AE35U + static_cast<std::uint32_t>(z) * 0x27D4EB2FU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  h *= 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<float>(h >> 8) * 0x1.0p-24F;
}

float Smooth(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double SignOfA(Side side) { return side == Side::kLeft || side == Side::kBack ? -1 : 1; }
double SignOfB(Side side) { return side == Side::kBottom ? 1 : -1; }

}  // namespace

Bgr Rgb(int red, int green, int blue) {
  return {static_cast<float>(blue), static_cast<float>(green), static_cast<float>(red)};
}

Bgr Mix(const Bgr& a, const Bgr& b, float share_of_b) { return a * (1 - share_of_b) + b * share_of_b; }

Colour Pigment(const Bgr& ink) { return {ink[0], ink[1], ink[2]}; }

float Ramp(float value, float low, float high) {
  const float t = std::clamp((value - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

float Noise(const Vec3& p, std::uint32_t seed) {
  const Vec3 cell(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
  const int x = static_cast<int>(cell.x()), y = static_cast<int>(cell.y()), z = static_cast<int>(cell.z());
  const float tx = Smooth(p.x() - cell.x()), ty = Smooth(p.y() - cell.y()), tz = Smooth(p.z() - cell.z());
  const auto row = [&](int dy, int dz) {
    return std::lerp(CellValue(x, y + dy, z + dz, seed), CellValue(x + 1, y + dy, z + dz, seed), tx);
  };
  const float value = std::lerp(std::lerp(row(0, 0), row(1, 0), ty), std::lerp(row(0, 1), row(1, 1), ty), tz);
  return 2 * value - 1;
}

float Fractal(const Vec3& p, std::uint32_t seed, int octaves) {
  float sum = 0;
  float strength = 0.6F;
  Vec3 at = p;
  for (int i = 0; i < octaves; ++i) {
    sum += strength * Noise(at, seed + static_cast<std::uint32_t>(i) * 101U);
    strength *= 0.5F;
    at = at * 2.03F + Vec3(17.3F, 5.1F, 9.7F);
  }
  return sum;
}

float Cells(const Vec3& p, std::uint32_t seed) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y())),
            z = static_cast<int>(std::floor(p.z()));
  float nearest = 4;
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        const int cx = x + dx, cy = y + dy, cz = z + dz;
        const Vec3 point(static_cast<float>(cx) + CellValue(cx, cy, cz, seed),
                         static_cast<float>(cy) + CellValue(cx, cy, cz, seed + 1),
                         static_cast<float>(cz) + CellValue(cx, cy, cz, seed + 2));
        nearest = std::min(nearest, (p - point).squaredNorm());
      }
    }
  }
  return std::sqrt(nearest);
}

Paint Coat(const Bgr& colour, float unevenness, std::uint32_t seed) {
  return [=](const Surface& s) { return colour * (1 + unevenness * 1.6F * Fractal(s.position * 1.3F, seed, 3)); };
}

Paint Camouflage(const Bgr& base, const std::vector<Patch>& patches, float patch_m, std::uint32_t seed) {
  return [=](const Surface& s) {
    const Vec3 bend(Noise(s.position / (patch_m * 0.6F), seed + 50), Noise(s.position / (patch_m * 0.6F), seed + 51),
                    Noise(s.position / (patch_m * 0.6F), seed + 52));
    const Vec3 at = s.position / patch_m + 0.28F * bend;
    Bgr colour = base;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const float height = Fractal(at, seed + static_cast<std::uint32_t>(i) * 7, 3);
      if (height > 0.42F * (1 - 2 * patches[i].fraction)) colour = patches[i].colour;
    }
    return Bgr(colour * (1 + 0.07F * Fractal(s.position * 2.1F, seed + 90, 3)));
  };
}

Paint Glass(std::uint32_t seed) {
  return [=](const Surface& s) {
    const float sky = Ramp(s.normal.y(), -0.2F, 1.0F);
    const float gleam =
        Ramp(Noise(Vec3(s.position.x() + s.position.y() * 0.8F, 0, s.position.z()) * 1.4F, seed), 0.1F, 0.35F);
    return Mix(Rgb(22, 28, 33), Rgb(120, 142, 158), 0.2F * sky + 0.35F * gleam);
  };
}

Paint Wheel(float radius, float rim_radius, const Bgr& rim, int bolts) {
  return [=](const Surface& s) {
    const float r = std::hypot(s.position.y(), s.position.z());
    const float angle = std::atan2(s.position.y(), s.position.z());
    if (r > rim_radius) {
      const bool tread = r > radius * 0.93F;
      const float lug = std::sin(angle * 36 + (s.position.x() > 0 ? 8.0F : -8.0F) * s.position.x());
      return Bgr(Rgb(46, 45, 44) * (tread && lug > 0.2F ? 0.6F : 1.0F));
    }
    const float spoke = std::cos(angle * static_cast<float>(bolts));
    if (r > rim_radius * 0.45F && r < rim_radius * 0.8F && spoke > 0.6F) return Bgr(rim * 0.35F);
    if (r < rim_radius * 0.18F) return Bgr(rim * 0.6F);
    return Bgr(rim * (r > rim_radius * 0.9F ? 0.7F : 1.0F));
  };
}

Paint Metal(const Bgr& colour, std::uint32_t seed) {
  return [=](const Surface& s) {
    const float brushed = Noise(Vec3(s.position.x() * 30, s.position.y() * 30, s.position.z() * 2), seed);
    return Bgr(colour * (1 + 0.10F * brushed + 0.12F * Fractal(s.position * 3, seed + 1, 2)));
  };
}

Bgr Weathered(const Weather& weather, const Bgr& colour, const Surface& surface) {
  const Vec3& p = surface.position;
  const float steep = 1 - std::abs(surface.normal.y());
  const float run = Noise(Vec3(p.x() * 11, p.y() * 0.7F, p.z() * 11), weather.seed);
  const float run_here = Ramp(run, 0.15F, 0.7F) * Ramp(Noise(p * 1.1F, weather.seed + 1), -0.3F, 0.5F);
  const float stain = Ramp(Fractal(p * 1.7F, weather.seed + 2, 3), 0.05F, 0.4F);
  const float grain = Noise(p * 34, weather.seed + 3) + 0.8F * Noise(p * 15, weather.seed + 4);
  float light = 1 - weather.streaks * steep * run_here - weather.stains * stain + weather.grain * grain;
  light += 0.5F * weather.stains * Ramp(Noise(p * 2.3F, weather.seed + 5), 0.1F, 0.7F);
  const float low = std::exp(-std::max(0.0F, p.y()) / weather.dust_height_m);
  const float patchy = 0.55F + 0.45F * Fractal(p * 2.7F, weather.seed + 6, 3);
  const float lying =
      0.25F * Ramp(surface.normal.y(), 0.5F, 0.95F) * Ramp(Fractal(p * 0.9F, weather.seed + 8, 3), 0.0F, 0.5F);
  const float dust = std::clamp(weather.dust_fraction * (1.4F * low * patchy + lying), 0.0F, 0.8F);
  return Mix(colour * light, weather.dust, dust);
}

Stencil::Stencil(const cv::Mat& image, cv::Point2d origin, double texels_per_m, Side side)
    : pencil_(image, origin, 0, texels_per_m), sign_a_(SignOfA(side)), sign_b_(SignOfB(side)) {}

void Stencil::Fill(const std::vector<cv::Point2d>& corners, const Colour& colour) {
  std::vector<cv::Point2d> placed;
  for (const cv::Point2d& corner : corners) placed.push_back(Place(corner.x, corner.y));
  pencil_.Fill(placed, colour);
}

void Stencil::Box(double a0, double b0, double a1, double b1, const Colour& colour) {
  Fill({{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}}, colour);
}

void Stencil::Frame(double a0, double b0, double a1, double b1, const Colour& colour, double thickness) {
  Path({{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}, {a0, b0}}, colour, thickness);
}

void Stencil::Disc(double a, double b, double radius, const Colour& colour) {
  const cv::Point2d at = Place(a, b);
  pencil_.Disc(at.x, at.y, radius, colour);
}

void Stencil::Ring(double a, double b, double radius, const Colour& colour, double thickness) {
  const cv::Point2d at = Place(a, b);
  pencil_.Ring(at.x, at.y, radius, colour, thickness);
}

void Stencil::Line(double a0, double b0, double a1, double b1, const Colour& colour, double thickness) {
  pencil_.Line(Place(a0, b0), Place(a1, b1), colour, thickness);
}

void Stencil::Path(const std::vector<cv::Point2d>& points, const Colour& colour, double thickness) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    Line(points[i].x, points[i].y, points[i + 1].x, points[i + 1].y, colour, thickness);
  }
}

void Stencil::Text(double a, double b, const std::string& text, double height, const Colour& colour, double stroke) {
  const cv::Point2d at = Place(a, b);
  pencil_.Text(at.x, at.y, text, height, 100, colour, stroke > 0 ? stroke : height * 0.17);
}

void Stencil::Panel(double a0, double b0, double a1, double b1) {
  constexpr double kIn = 0.025;
  const double left = std::min(a0, a1), right = std::max(a0, a1), low = std::min(b0, b1), high = std::max(b0, b1);
  Frame(left + kIn, low + kIn, right - kIn, high - kIn, kRidge);
  Frame(left, low, right, high, kGroove);
  for (const double a : {left + 3 * kIn, right - 3 * kIn}) {
    for (const double b : {low + 3 * kIn, high - 3 * kIn}) Disc(a, b, 0.02, kGroove);
  }
}

void Stencil::Rivets(double a0, double b0, double a1, double b1, double step) {
  const int count = std::max(1, static_cast<int>(std::hypot(a1 - a0, b1 - b0) / step));
  for (int i = 0; i <= count; ++i) {
    const double t = static_cast<double>(i) / count;
    Disc(std::lerp(a0, a1, t), std::lerp(b0, b1, t), 0.014, Colour{95});
  }
}

void Stencil::Grille(double a0, double b0, double a1, double b1, int slots, bool along_a) {
  for (int i = 0; i < slots; ++i) {
    const double from = static_cast<double>(i) / slots;
    const double to = (i + 0.62) / slots;
    if (along_a) {
      Box(a0, std::lerp(b0, b1, from), a1, std::lerp(b0, b1, to), Colour{45});
    } else {
      Box(std::lerp(a0, a1, from), b0, std::lerp(a0, a1, to), b1, Colour{45});
    }
  }
  Frame(a0, b0, a1, b1, kRidge);
}

void Stencil::Hazard(double a0, double b0, double a1, double b1, const Colour& first, const Colour& second,
                     double stripe) {
  Box(a0, b0, a1, b1, first);
  const double low = std::min(b0, b1), high = std::max(b0, b1), left = std::min(a0, a1), right = std::max(a0, a1);
  const double rise = high - low;
  for (double a = left - rise; a < right; a += 2 * stripe) {
    // The diagonal band, clipped at the box's ends.
    std::vector<cv::Point2d> band;
    for (const auto& [at, b] : {std::pair{a, low}, {a + stripe, low}, {a + stripe + rise, high}, {a + rise, high}}) {
      const double cut = std::clamp(at, left, right);
      band.emplace_back(cut, b);
    }
    Fill(band, second);
  }
}

}  // namespace victorious::assets
