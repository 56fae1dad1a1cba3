// A pencil for drawn worlds: shapes in their own coordinates, colours, and noise that looks the same on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "victorious/base/random.h"

namespace victorious::testing {

using Colour = cv::Scalar;  ///< blue, green, red: 0 to 255

/// The colour made brighter (factor > 1) or darker.
Colour Shade(const Colour& colour, double factor);

/// A colour of the list, a little brighter or darker.
Colour PickColour(std::initializer_list<Colour> palette, Random& random);

/// Zero mean, unit variance, CV_32F; its bumps are about `wavelength_px` wide.
cv::Mat SmoothNoise(cv::Size size, double wavelength_px, Random& random);

/// image *= 1 + noise * strength / 255, pixel by pixel, from `strength` (CV_8U) and `noise` (CV_32F).
void ApplyTexture(cv::Mat& image, const cv::Mat& noise, const cv::Mat& strength);

/// `count` letters and digits that cannot be mistaken for each other.
std::string RandomLabel(int count, Random& random);

struct Range {
  double low;
  double high;
};

/// A uniform draw from each range, in their order. (Draws that stand side by side in one expression come in an order of
/// the compiler's own choice.)
template <std::size_t N>
std::array<double, N> Uniforms(Random& random, const Range (&ranges)[N]) {
  std::array<double, N> draws;
  for (std::size_t i = 0; i < N; ++i) draws[i] = random.Uniform(ranges[i].low, ranges[i].high);
  return draws;
}

/// Draws on a picture in coordinates of its own: turned, moved and scaled. Every shape is anti-aliased.
class Pencil {
 public:
  /// @param picture  drawn on, shared
  /// @param origin   where the pencil's (0, 0) lies, px
  /// @param angle_rad  from the picture's +x towards +y
  /// @param scale    picture pixels per unit
  Pencil(const cv::Mat& picture, cv::Point2d origin, double angle_rad = 0.0, double scale = 1.0);

  /// The same place and turn on another picture.
  [[nodiscard]] Pencil On(const cv::Mat& picture) const;
  [[nodiscard]] cv::Point2d ToPicture(cv::Point2d point) const;

  void Fill(const std::vector<cv::Point2d>& corners, const Colour& colour);
  /// The rectangle about (x, y) of the given width and height.
  void Box(double x, double y, double width, double height, const Colour& colour);
  void Frame(double x, double y, double width, double height, const Colour& colour, double thickness = 1.0);
  void Disc(double x, double y, double radius, const Colour& colour);
  void Oval(double x, double y, double half_width, double half_height, const Colour& colour);
  void Ring(double x, double y, double radius, const Colour& colour, double thickness = 1.0);
  void Line(cv::Point2d from, cv::Point2d to, const Colour& colour, double thickness = 1.0);
  /// Stroke letters, centred at (x, y), `height` units high, never wider than `max_width`. Along the picture's x.
  void Text(double x, double y, const std::string& text, double height, double max_width, const Colour& colour,
            double thickness);

 private:
  [[nodiscard]] cv::Point Fixed(cv::Point2d point) const;
  [[nodiscard]] int Thickness(double units) const;

  cv::Mat picture_;
  cv::Point2d origin_;
  double angle_rad_;
  double cosine_;
  double sine_;
  double scale_;
};

}  // namespace victorious::testing
