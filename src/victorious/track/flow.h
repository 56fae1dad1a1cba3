// track/, points from one frame to another: pyramidal Lucas-Kanade, followed on and back again.
// Source: J.-Y. Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker", Intel, 2000; the check is that
// of Z. Kalal, K. Mikolajczyk and J. Matas, "Forward-backward error", ICPR 2010.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/polygon.h"
#include "victorious/track/track_options.h"

namespace victorious {

/// A frame's pyramid with its gradients, made once and shared by everything that is followed into or out of the frame.
class FlowPyramid {
 public:
  /// @param grey  CV_8UC1; shared, not copied
  FlowPyramid(const cv::Mat& grey, const TrackOptions& options);

  [[nodiscard]] const cv::Mat& grey() const { return grey_; }
  [[nodiscard]] const std::vector<cv::Mat>& levels() const { return levels_; }

 private:
  cv::Mat grey_;
  std::vector<cv::Mat> levels_;
};

/// Where each point of `from` went.
/// @param guesses  where to begin, one a point, px
/// @return one a point; nothing for those that left the frame, or did not come back to within forward_backward_px
std::vector<std::optional<Eigen::Vector2d>> FollowPoints(const FlowPyramid& from, const FlowPyramid& to,
                                                         std::span<const Eigen::Vector2d> points,
                                                         std::span<const Eigen::Vector2d> guesses,
                                                         const TrackOptions& options);

/// Points inside an outline that can be followed well (Shi and Tomasi 1994), best first, spread evenly.
/// @param grey  CV_8UC1
std::vector<Eigen::Vector2d> ChoosePoints(const cv::Mat& grey, const Polygon& outline, int most);

}  // namespace victorious
