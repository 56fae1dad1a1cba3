#include "victorious/lab/evaluate/drawn_clutter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// A sum of noise octaves whose amplitude rises with the wavelength, as natural ground.
cv::Mat MakeGroundNoise(cv::Size size, Random& random) {
  constexpr double kContrast = 2.2;  // grey levels, amplitude of an octave with a wavelength of one pixel
  cv::Mat ground(size, CV_32F, cv::Scalar(random.Uniform(95, 150)));
  for (int wavelength_px = 2; wavelength_px <= 128; wavelength_px *= 2) {
    cv::Mat draws(size.height / wavelength_px + 3, size.width / wavelength_px + 3, CV_32F);
    for (int row = 0; row < draws.rows; ++row) {
      for (int column = 0; column < draws.cols; ++column)
        draws.at<float>(row, column) = static_cast<float>(random.Normal());
    }
    cv::Mat octave;
    cv::resize(draws, octave, {draws.cols * wavelength_px, draws.rows * wavelength_px}, 0, 0, cv::INTER_CUBIC);
    ground += octave(cv::Rect({0, 0}, size)) * (kContrast * std::sqrt(wavelength_px));
  }
  return ground;
}

// Draws a rectangle of one grey at a random place, often with a row of smaller ones on it: windows, planks, parked
// cars.
void DrawRectangle(cv::Mat& image, Random& random) {
  constexpr int kFine = 4;  // bits of a pixel's fraction
  const double angle_rad = random.Uniform(-kPi, kPi);
  const double width_px = std::exp(random.Uniform(std::log(6.0), std::log(120.0)));
  const double height_px = std::max(2.0, width_px * random.Uniform(0.1, 0.8));
  const Eigen::Vector2d middle(random.Uniform() * image.cols, random.Uniform() * image.rows);
  const Eigen::Rotation2Dd turn(angle_rad);
  const auto fill = [&](double x, double y, double half_x, double half_y, double grey) {
    std::vector<cv::Point> corners;
    for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      const Eigen::Vector2d at = middle + turn * Eigen::Vector2d(x + a * half_x, y + b * half_y);
      corners.emplace_back(cvRound(at.x() * (1 << kFine)), cvRound(at.y() * (1 << kFine)));
    }
    cv::fillConvexPoly(image, corners, cv::Scalar(grey), cv::LINE_AA, kFine);
  };
  const double grey = random.Uniform(30, 225);
  fill(0, 0, width_px / 2, height_px / 2, grey);
  const int parts = static_cast<int>(random.Below(6));
  const double other = grey + random.Uniform(-60, 60);
  for (int i = 0; i < parts; ++i) {
    const double x = width_px * ((i + 0.5) / parts - 0.5);
    fill(x, 0, width_px / parts * 0.3, height_px * 0.3, other);
  }
}

}  // namespace

cv::Mat DrawClutter(cv::Size size, std::uint64_t seed) {
  constexpr double kRectanglesPerPixel = 130.0 / (640 * 480);
  Random random(seed);
  cv::Mat ground = MakeGroundNoise(size, random);
  cv::Mat image;
  ground.convertTo(image, CV_8U);
  const int rectangle_count = static_cast<int>(kRectanglesPerPixel * size.area());
  for (int i = 0; i < rectangle_count; ++i) DrawRectangle(image, random);
  // Adds noise to the rectangles too.
  cv::Mat noise = MakeGroundNoise(size, random);
  noise = (noise - cv::mean(noise)[0]) * 0.35;
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  return image;
}

}  // namespace victorious
