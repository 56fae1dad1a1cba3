// Drawing primitives for synthetic images: shapes in local coordinates, colours, and reproducible noise.
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

/// Returns the colour scaled by `factor`: brighter (factor > 1) or darker.
Colour Shade(const Colour& colour, double factor);

/// Returns a random colour of the list with a small random change of brightness.
Colour PickColour(std::initializer_list<Colour> palette, Random& random);

/// Returns smooth noise of zero mean and unit variance (CV_32F) with a correlation length of about `wavelength_px`.
cv::Mat SmoothNoise(cv::Size size, double wavelength_px, Random& random);

/// image *= 1 + noise * strength / 255, pixel by pixel, from `strength` (CV_8U) and `noise` (CV_32F).
void ApplyTexture(cv::Mat& image, const cv::Mat& noise, const cv::Mat& strength);

/// Returns `count` random letters and digits, without characters that look alike.
std::string RandomLabel(int count, Random& random);

struct Range {
  double low;
  double high;
};

/// Draws one uniform number from each range, in order. (Within one expression, the compiler may choose the order of
/// evaluation.)
template <std::size_t N>
std::array<double, N> Uniforms(Random& random, const Range (&ranges)[N]) {
  std::array<double, N> draws;
  for (std::size_t i = 0; i < N; ++i) draws[i] = random.Uniform(ranges[i].low, ranges[i].high);
  return draws;
}

/// Draws anti-aliased shapes on an image in a local coordinate system (rotated, translated, scaled).
class Pencil {
 public:
  /// @param image  the image to draw on; shared
  /// @param origin   the local origin in the image, px
  /// @param angle_rad  rotation from the image's +x towards +y
  /// @param scale    image pixels per local unit
  Pencil(const cv::Mat& image, cv::Point2d origin, double angle_rad = 0.0, double scale = 1.0);

  /// Returns a pencil with the same coordinate system on another image.
  [[nodiscard]] Pencil On(const cv::Mat& image) const;
  [[nodiscard]] cv::Point2d ToImage(cv::Point2d point) const;

  void Fill(const std::vector<cv::Point2d>& corners, const Colour& colour);
  /// A filled rectangle centred at (x, y).
  void Box(double x, double y, double width, double height, const Colour& colour);
  void Frame(double x, double y, double width, double height, const Colour& colour, double thickness = 1.0);
  void Disc(double x, double y, double radius, const Colour& colour);
  void Oval(double x, double y, double half_width, double half_height, const Colour& colour);
  void Ring(double x, double y, double radius, const Colour& colour, double thickness = 1.0);
  void Line(cv::Point2d from, cv::Point2d to, const Colour& colour, double thickness = 1.0);
  /// Text in a stroke font, centred at (x, y), `height` units high, at most `max_width` wide, along the image's x axis.
  void Text(double x, double y, const std::string& text, double height, double max_width, const Colour& colour,
            double thickness);

 private:
  [[nodiscard]] cv::Point Fixed(cv::Point2d point) const;
  [[nodiscard]] int Thickness(double units) const;

  cv::Mat image_;
  cv::Point2d origin_;
  double angle_rad_;
  double cosine_;
  double sine_;
  double scale_;
};

}  // namespace victorious::testing
