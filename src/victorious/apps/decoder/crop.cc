#include "victorious/apps/decoder/crop.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace victorious {

Box CropRegion(const Box& box, int frame_width_px, int frame_height_px) {
  constexpr double kMargin = 1.5;  // side of the region over the side of the box
  constexpr double kMinHeight_px = 48;
  constexpr double kAspect = 4.0 / 3;
  const double height = std::max({kMinHeight_px, kMargin * box.height, kMargin * box.width / kAspect});
  Box region{0, 0, kAspect * height, height};
  const auto place = [](double centre, double side, double limit) {
    if (side >= limit) return (limit - side) / 2;
    return std::clamp(centre - side / 2, 0.0, limit - side);
  };
  region.x = place(box.x + box.width / 2, region.width, frame_width_px);
  region.y = place(box.y + box.height / 2, region.height, frame_height_px);
  return region;
}

cv::Mat CutOut(const cv::Mat& frame, const Box& region, int width_px) {
  // A border where the region extends beyond the frame.
  cv::Mat cut;
  const double scale = width_px / region.width;
  const cv::Size size(width_px, static_cast<int>(std::lround(region.height * scale)));
  const cv::Matx23d cut_from_frame(scale, 0, -region.x * scale, 0, scale, -region.y * scale);
  const int interpolation = scale < 1 ? cv::INTER_AREA : cv::INTER_CUBIC;
  if (const cv::Rect inside(cv::Point2d(std::floor(region.x), std::floor(region.y)),
                            cv::Point2d(std::ceil(region.x + region.width), std::ceil(region.y + region.height)));
      scale < 1 && (inside & cv::Rect({0, 0}, frame.size())) == inside) {
    cv::resize(frame(inside), cut, size, 0, 0, interpolation);
  } else {
    cv::warpAffine(frame, cut, cut_from_frame, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(24));
  }
  return cut;
}

}  // namespace victorious
