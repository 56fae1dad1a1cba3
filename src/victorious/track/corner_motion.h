// track/: the similarity by which a part of the image moves between two frames. Corners are tracked by Lucas-Kanade
// (flow.h), and MLESAC fits the similarity.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/geometry/similarity.h"
#include "victorious/geometry/solvers/similarity.h"
#include "victorious/track/flow.h"

namespace victorious {

inline constexpr int kMotionCorners = 80;             ///< a similarity has 4 unknowns; more cost time without gain
inline constexpr std::size_t kMinMotionInliers = 12;  ///< fewer: a cut, or no texture

struct CornerMotionOptions {
  double image_scale = 1;       ///< size of the pyramids' images relative to the frame
  double noise_px = 1;          ///< standard deviation of a tracked corner, px of the frame
  double outlier_area_px2 = 0;  ///< area over which outliers are uniform (MLESAC), px of the frame
};

/// Tracks corners from one frame to another. Some are wrong.
/// @param corners  px, in `from`
/// @return those that were tracked, px of the frame
std::vector<PointPair> TrackCorners(const FlowPyramid& from, const FlowPyramid& to,
                                    std::span<const Eigen::Vector2d> corners, double image_scale);

/// @param pairs  of TrackCorners
/// @return as EstimateCornerMotion
std::optional<Similarity2> FitCornerMotion(std::span<const PointPair> pairs, const CornerMotionOptions& options);

/// @param corners  px, in `from`
/// @return the similarity, px of the frame; std::nullopt with fewer than kMinMotionInliers inliers
std::optional<Similarity2> EstimateCornerMotion(const FlowPyramid& from, const FlowPyramid& to,
                                                std::span<const Eigen::Vector2d> corners,
                                                const CornerMotionOptions& options);

}  // namespace victorious
