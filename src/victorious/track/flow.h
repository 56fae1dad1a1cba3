// track/: sparse optical flow between two frames by pyramidal Lucas-Kanade with a forward-backward check.
// Sources: J.-Y. Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker", Intel, 2000; Z. Kalal,
// K. Mikolajczyk and J. Matas, "Forward-backward error", ICPR 2010.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/geometry/polygon.h"
#include "victorious/track/track_options.h"

namespace victorious {

/// A frame's image pyramid with gradients. Made once per frame and shared by all tracks. Each frame is normalised to
/// the same mean and contrast, against changes of exposure.
class FlowPyramid {
 public:
  /// @param grey  CV_8UC1; shared, not copied
  explicit FlowPyramid(const cv::Mat& grey, const FlowOptions& options = {});

  [[nodiscard]] const cv::Mat& grey() const { return grey_; }
  [[nodiscard]] const std::vector<cv::Mat>& levels() const { return levels_; }
  [[nodiscard]] const FlowOptions& options() const { return options_; }

 private:
  cv::Mat grey_;
  FlowOptions options_;
  std::vector<cv::Mat> levels_;
};

/// Tracks points from one frame to another, by the options of both pyramids, which must be the same.
/// @param points   px, in `from`
/// @param guesses  initial positions in `to`, px, one per point
/// @return the positions in `to`, px, one per point; std::nullopt for a point that left the frame or whose
///   forward-backward error exceeds max_forward_backward_px; all std::nullopt if the frames differ in size
std::vector<std::optional<Eigen::Vector2d>> TrackPointsForwardBackward(const FlowPyramid& from, const FlowPyramid& to,
                                                                       std::span<const Eigen::Vector2d> points,
                                                                       std::span<const Eigen::Vector2d> guesses);

/// Detects corners inside an outline (Shi and Tomasi 1994), spread evenly.
/// @param grey  CV_8UC1
/// @param max_points  upper bound on the number of corners
/// @return positions, px, strongest corner first
std::vector<Eigen::Vector2d> DetectCorners(const cv::Mat& grey, const Polygon& outline, int max_points);

}  // namespace victorious
