#include "testing/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <opencv2/imgproc.hpp>

#include "victorious/geometry/angles.h"

namespace victorious::testing {
namespace {

constexpr int kFixedBits = 4;  // OpenCV draws with a resolution of 1/16 px
constexpr double kFixedOne = 1 << kFixedBits;

}  // namespace

Colour Shade(const Colour& colour, double factor) {
  return {std::min(255.0, colour[0] * factor), std::min(255.0, colour[1] * factor),
          std::min(255.0, colour[2] * factor)};
}

Colour PickColour(std::initializer_list<Colour> palette, Random& random) {
  const Colour colour = palette.begin()[random.Below(static_cast<std::uint32_t>(palette.size()))];
  return Shade(colour, random.Uniform(0.92, 1.08));
}

cv::Mat SmoothNoise(cv::Size size, double wavelength_px, Random& random) {
  const auto cells = [&](int length_px) { return static_cast<int>(std::ceil(length_px / wavelength_px)) + 1; };
  cv::Mat grid(cells(size.height), cells(size.width), CV_32F);
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.cols; ++x) {
      // Unit variance, approximately normal, bounded.
      const auto [a, b, c] = Uniforms(random, {{-1, 1}, {-1, 1}, {-1, 1}});
      grid.at<float>(y, x) = static_cast<float>(a + b + c);
    }
  }
  cv::Mat noise;
  cv::resize(grid, noise, size, 0, 0, cv::INTER_CUBIC);
  return noise;
}

void ApplyTexture(cv::Mat& image, const cv::Mat& noise, const cv::Mat& strength) {
  for (int y = 0; y < image.rows; ++y) {
    auto* pixel = image.ptr<cv::Vec3b>(y);
    const auto* value = noise.ptr<float>(y);
    const auto* weight = strength.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x) {
      const float factor = 1.0F + value[x] * static_cast<float>(weight[x]) / 255.0F;
      for (int channel = 0; channel < 3; ++channel) {
        pixel[x][channel] = cv::saturate_cast<std::uint8_t>(static_cast<float>(pixel[x][channel]) * factor);
      }
    }
  }
}

std::string RandomLabel(int count, Random& random) {
  constexpr std::string_view kSigns = "ABCDEFGHJKLMNPRSTUVXYZ23456789";
  std::string label;
  while (static_cast<int>(label.size()) < count) label += kSigns[random.Below(kSigns.size())];
  return label;
}

Pencil::Pencil(const cv::Mat& image, cv::Point2d origin, double angle_rad, double scale)
    : image_(image),
      origin_(origin),
      angle_rad_(angle_rad),
      cosine_(std::cos(angle_rad)),
      sine_(std::sin(angle_rad)),
      scale_(scale) {}

Pencil Pencil::On(const cv::Mat& image) const { return {image, origin_, angle_rad_, scale_}; }

cv::Point2d Pencil::ToImage(cv::Point2d point) const {
  return origin_ + scale_ * cv::Point2d(cosine_ * point.x - sine_ * point.y, sine_ * point.x + cosine_ * point.y);
}

cv::Point Pencil::Fixed(cv::Point2d point) const {
  const cv::Point2d at = ToImage(point) - cv::Point2d(0.5, 0.5);  // OpenCV's pixel centres are at integers
  return {cvRound(at.x * kFixedOne), cvRound(at.y * kFixedOne)};
}

int Pencil::Thickness(double units) const { return std::max(1, cvRound(units * scale_)); }

void Pencil::Fill(const std::vector<cv::Point2d>& corners, const Colour& colour) {
  std::vector<std::vector<cv::Point>> outline(1);
  for (const cv::Point2d& corner : corners) outline[0].push_back(Fixed(corner));
  cv::fillPoly(image_, outline, colour, cv::LINE_AA, kFixedBits);
}

void Pencil::Box(double x, double y, double width, double height, const Colour& colour) {
  const double w = width / 2;
  const double h = height / 2;
  const cv::Point corners[] = {Fixed({x - w, y - h}), Fixed({x + w, y - h}), Fixed({x + w, y + h}),
                               Fixed({x - w, y + h})};
  cv::fillConvexPoly(image_, corners, 4, colour, cv::LINE_AA, kFixedBits);
}

void Pencil::Frame(double x, double y, double width, double height, const Colour& colour, double thickness) {
  const double w = width / 2;
  const double h = height / 2;
  const std::vector<cv::Point> corners = {Fixed({x - w, y - h}), Fixed({x + w, y - h}), Fixed({x + w, y + h}),
                                          Fixed({x - w, y + h})};
  cv::polylines(image_, corners, true, colour, Thickness(thickness), cv::LINE_AA, kFixedBits);
}

void Pencil::Disc(double x, double y, double radius, const Colour& colour) {
  cv::circle(image_, Fixed({x, y}), cvRound(radius * scale_ * kFixedOne), colour, cv::FILLED, cv::LINE_AA, kFixedBits);
}

void Pencil::Oval(double x, double y, double half_width, double half_height, const Colour& colour) {
  const cv::Size axes(cvRound(half_width * scale_ * kFixedOne), cvRound(half_height * scale_ * kFixedOne));
  cv::ellipse(image_, Fixed({x, y}), axes, DegreesFromRadians(angle_rad_), 0, 360, colour, cv::FILLED, cv::LINE_AA,
              kFixedBits);
}

void Pencil::Ring(double x, double y, double radius, const Colour& colour, double thickness) {
  cv::circle(image_, Fixed({x, y}), cvRound(radius * scale_ * kFixedOne), colour, Thickness(thickness), cv::LINE_AA,
             kFixedBits);
}

void Pencil::Line(cv::Point2d from, cv::Point2d to, const Colour& colour, double thickness) {
  cv::line(image_, Fixed(from), Fixed(to), colour, Thickness(thickness), cv::LINE_AA, kFixedBits);
}

void Pencil::Text(double x, double y, const std::string& text, double height, double max_width, const Colour& colour,
                  double thickness) {
  const int stroke = Thickness(thickness);
  double font_scale = cv::getFontScaleFromHeight(cv::FONT_HERSHEY_SIMPLEX, cvRound(height * scale_), stroke);
  int baseline = 0;
  cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale, stroke, &baseline);
  const double too_wide = size.width / (max_width * scale_);
  if (too_wide > 1) {
    font_scale /= too_wide;
    size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale, stroke, &baseline);
  }
  const cv::Point2d centre = ToImage({x, y});
  cv::putText(image_, text, cv::Point(cvRound(centre.x - size.width / 2.0), cvRound(centre.y + size.height / 2.0)),
              cv::FONT_HERSHEY_SIMPLEX, font_scale, colour, stroke, cv::LINE_AA);
}

}  // namespace victorious::testing
