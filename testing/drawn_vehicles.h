// Images of small vehicles from above, with their boxes: for tests of detectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "victorious/base/random.h"
#include "victorious/geometry/box.h"

namespace victorious::testing {

struct VehicleImage {
  cv::Mat image;  ///< BGR
  std::vector<Box> boxes;
};

/// Draws a vehicle: a bright body with a dark windscreen. Returns its box.
inline Box DrawVehicle(cv::Mat& image, cv::Point2d middle, double length_px, double heading_rad,
                       const cv::Scalar& colour) {
  const auto part = [&](double from, double to, double half_width, const cv::Scalar& fill) {
    std::vector<cv::Point> corners;
    std::vector<cv::Point2d> exact;
    for (const auto& [along, across] : {std::pair{from, -half_width}, std::pair{to, -half_width},
                                        std::pair{to, half_width}, std::pair{from, half_width}}) {
      exact.emplace_back(middle.x + length_px * (along * std::cos(heading_rad) - across * std::sin(heading_rad)),
                         middle.y + length_px * (along * std::sin(heading_rad) + across * std::cos(heading_rad)));
      corners.emplace_back(cvRound(16 * exact.back().x), cvRound(16 * exact.back().y));
    }
    cv::fillConvexPoly(image, corners, fill, cv::LINE_AA, 4);
    return exact;
  };
  const std::vector<cv::Point2d> body = part(-0.5, 0.5, 0.22, colour);
  part(0.12, 0.26, 0.17, {30, 30, 30});
  part(-0.38, -0.28, 0.17, {40, 40, 40});
  const auto [left, right] = std::ranges::minmax(body, {}, &cv::Point2d::x);
  const auto [top, bottom] = std::ranges::minmax(body, {}, &cv::Point2d::y);
  return {left.x, top.y, right.x - left.x, bottom.y - top.y};
}

/// A street of 320 x 240 px: eight vehicles, and squares and discs that are none.
/// @param headings  number of headings modulo 180 degrees, from the x axis
inline VehicleImage DrawStreet(std::uint64_t seed, int headings) {
  Random random(seed);
  VehicleImage street{.image = cv::Mat(240, 320, CV_8UC3, {90, 95, 90}), .boxes = {}};
  const auto colour = [&] {
    return cv::Scalar(random.Uniform(130, 255), random.Uniform(130, 255), random.Uniform(130, 255));
  };
  constexpr double kCell = 80;
  for (int cell = 0; cell < 12; ++cell) {
    const cv::Point2d middle((cell % 4 + 0.5) * kCell + random.Uniform(-8, 8),
                             (cell / 4 + 0.5) * kCell + random.Uniform(-8, 8));
    const double size = random.Uniform(30, 50);
    if (cell % 3 != 2) {
      const double heading = CV_PI / headings * random.Below(static_cast<std::uint32_t>(headings));
      street.boxes.push_back(DrawVehicle(street.image, middle, size, heading, colour()));
    } else if (cell % 2 == 0) {
      cv::circle(street.image, middle, cvRound(size / 2), colour(), cv::FILLED, cv::LINE_AA);
    } else {
      const cv::Point half(cvRound(size / 2), cvRound(size / 2));
      cv::rectangle(street.image, cv::Point(middle) - half, cv::Point(middle) + half, colour(), cv::FILLED);
    }
  }
  cv::Mat noise(street.image.size(), CV_8UC3);
  cv::RNG(seed).fill(noise, cv::RNG::UNIFORM, 0, 12);
  street.image += noise;
  return street;
}

}  // namespace victorious::testing
