// Private to recognize/, for ShapeSearch: the responses of a bank of templates over a part of a frame.
#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "victorious/search/recognize/shape_templates.h"
#include "victorious/search/shape/gradient_cells.h"

namespace victorious {

inline constexpr int kCellStride = kCellSide_px / kCellStep_px;

/// The largest response at each position, and the template that gives it. Empty matrices without positions.
struct ResponseMap {
  cv::Mat response;  ///< CV_32F
  cv::Mat which;     ///< CV_32S, index into the bank
};

/// @param phase         which of the four first cells is the first
/// @param positions_at  of the templates' middles, in every second cell; beyond the cells is mean background
[[nodiscard]] ResponseMap Respond(const GradientCells& cells, const cv::Point& phase, const ShapeBank& bank,
                                  const cv::Rect& positions_at, const std::array<float, kCellOrientations>& mean);

/// Where the maximum of the parabolas through a peak and its neighbours lies, beside the peak: at most half a step.
[[nodiscard]] Eigen::Vector2d PeakOffset(const cv::Mat& responses, const cv::Point& peak);

}  // namespace victorious
