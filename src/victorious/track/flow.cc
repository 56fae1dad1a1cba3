#include "victorious/track/flow.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

// In OpenCV (0, 0) is the first pixel's centre; here it is the first pixel's corner.
cv::Point2f ToCv(const Eigen::Vector2d& point) {
  return {static_cast<float>(point.x() - 0.5), static_cast<float>(point.y() - 0.5)};
}
Eigen::Vector2d FromCv(const cv::Point2f& point) { return {point.x + 0.5, point.y + 0.5}; }

std::vector<cv::Point2f> ToCv(std::span<const Eigen::Vector2d> points) {
  std::vector<cv::Point2f> out;
  out.reserve(points.size());
  for (const Eigen::Vector2d& point : points) out.push_back(ToCv(point));
  return out;
}

// Lucas-Kanade assumes constant brightness. A fixed mean and standard deviation for every frame compensate exposure.
cv::Mat NormaliseContrast(const cv::Mat& grey) {
  constexpr double kMean = 128;          // the middle of the range
  constexpr double kDeviation = 45;      // nearly three of them fit on either side: few pixels are clipped
  constexpr double kNoiseDeviation = 3;  // a standard deviation below this is noise
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  if (deviation[0] < kNoiseDeviation) return grey;
  const double gain = kDeviation / deviation[0];
  cv::Mat normalised;
  grey.convertTo(normalised, CV_8U, gain, kMean - gain * mean[0]);
  return normalised;
}

}  // namespace

FlowPyramid::FlowPyramid(const cv::Mat& grey, const FlowOptions& options) : grey_(grey), options_(options) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1 && !grey.empty());
  cv::buildOpticalFlowPyramid(NormaliseContrast(grey), levels_, {options.window_px, options.window_px},
                              options.pyramid_levels - 1);
}

std::vector<std::optional<Eigen::Vector2d>> TrackPointsForwardBackward(const FlowPyramid& from, const FlowPyramid& to,
                                                                       std::span<const Eigen::Vector2d> points,
                                                                       std::span<const Eigen::Vector2d> guesses) {
  VICTORIOUS_CHECK(points.size() == guesses.size());
  const FlowOptions& options = to.options();
  std::vector<std::optional<Eigen::Vector2d>> followed(points.size());
  if (points.empty() || from.grey().size() != to.grey().size()) return followed;
  const cv::Size window(options.window_px, options.window_px);
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.03);
  const std::vector<cv::Point2f> start = ToCv(points);
  std::vector<cv::Point2f> end = ToCv(guesses);
  std::vector<cv::Point2f> back = start;
  std::vector<std::uint8_t> found_forward;
  std::vector<std::uint8_t> found_back;
  cv::calcOpticalFlowPyrLK(from.levels(), to.levels(), start, end, found_forward, cv::noArray(), window,
                           options.pyramid_levels - 1, criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  cv::calcOpticalFlowPyrLK(to.levels(), from.levels(), end, back, found_back, cv::noArray(), window,
                           options.pyramid_levels - 1, criteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  const cv::Rect2f inside(-0.5F, -0.5F, static_cast<float>(to.grey().cols), static_cast<float>(to.grey().rows));
  for (std::size_t i = 0; i < followed.size(); ++i) {
    if (found_forward[i] == 0 || found_back[i] == 0 || !inside.contains(end[i])) continue;
    if (cv::norm(back[i] - start[i]) <= options.max_forward_backward_px) followed[i] = FromCv(end[i]);
  }
  return followed;
}

std::vector<Eigen::Vector2d> DetectCorners(const cv::Mat& grey, const Polygon& outline, int max_points) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1);
  const Box box =
      BoundingBox(ClipToBox(outline, {0, 0, static_cast<double>(grey.cols), static_cast<double>(grey.rows)}));
  const auto left = static_cast<int>(std::floor(box.x));
  const auto top = static_cast<int>(std::floor(box.y));
  // A sum of doubles may lie a little beyond the border.
  const cv::Rect region = cv::Rect(left, top, static_cast<int>(std::ceil(box.x + box.width)) - left,
                                   static_cast<int>(std::ceil(box.y + box.height)) - top) &
                          cv::Rect({0, 0}, grey.size());
  if (region.area() <= 0 || max_points <= 0) return {};
  cv::Mat mask = cv::Mat::zeros(region.size(), CV_8UC1);
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& corner : outline)
    corners.emplace_back(static_cast<int>(std::lround(corner.x() - 0.5)) - left,
                         static_cast<int>(std::lround(corner.y() - 0.5)) - top);
  cv::fillPoly(mask, corners, 255);
  const double spacing_px = std::max(1.0, 0.5 * std::sqrt(region.area() / static_cast<double>(max_points)));
  std::vector<cv::Point2f> chosen;
  cv::goodFeaturesToTrack(grey(region), chosen, max_points, 0.01, spacing_px, mask);
  std::vector<Eigen::Vector2d> points;
  points.reserve(chosen.size());
  for (const cv::Point2f& point : chosen) points.push_back(FromCv(point) + Eigen::Vector2d(left, top));
  return points;
}

}  // namespace victorious
