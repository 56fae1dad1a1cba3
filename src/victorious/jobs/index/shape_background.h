// jobs/, what the search by shape (search/recognize/shape_search.h) learns from a few frames of a video before it
// begins: the background, as gradient cells, and where the camera is unknown how large objects are
// (search/recognize/common_view.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/search/recognize/common_view.h"
#include "victorious/search/recognize/shape_search.h"
#include "victorious/search/shape/gradient_cells.h"

namespace victorious {

inline constexpr int kBackgroundFrames = 4;
inline constexpr int kViewFrames = 8;     ///< for FindCommonView, and ShapeSearch::SearchByContours
inline constexpr int kViewSide_px = 800;  ///< of larger frames for it: every size and angle is tried in each

/// Frames evenly spread over a video, grey, without impulse noise. The same for each part of a video that is searched
/// apart. Fewer, or none, where frames cannot be read: the search of the same video reports why.
/// @param video             path
/// @param duration_s        of the video; frames of an unknown duration are taken from its beginning
/// @param impulse_fraction  as FeatureOptions::impulse_fraction
/// Error: kCancelled. Cost: a seek each, and what lies between a key frame and each frame; where key frames are rare,
/// the video is decoded once.
[[nodiscard]] Expected<std::vector<cv::Mat>> ReadSpreadFrames(const std::string& video, double duration_s, int count,
                                                              double impulse_fraction, const CancelToken& cancel);

/// Cells of all frames, at several scales.
[[nodiscard]] std::vector<GradientCells> BackgroundOf(std::span<const cv::Mat> frames);

/// As FindCommonView, for frames of this size. Errors: those of ShapeSearch::FindInAnyView; kCancelled.
[[nodiscard]] Expected<std::optional<CommonView>> EstimateCommonView(const ShapeSearch& shapes,
                                                                     std::span<const cv::Mat> frames,
                                                                     const CancelToken& cancel);

}  // namespace victorious
