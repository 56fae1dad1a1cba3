// recognize/: how objects that stand on the ground look in a video whose camera is unknown: how large, and from which
// off-nadir angle. What looks like an object in one size looks like nothing in another, but in frames without any
// camera every size is possible: of a model alone, a match by shape proves little (ShapeSearch::FindInAnyView). Several
// models that stand in one flight agree on size and off-nadir angle; what only looks like them does not.
#pragma once

#include <optional>
#include <span>

#include <opencv2/core/types.hpp>

#include "victorious/search/recognize/shape_search.h"
#include "victorious/types/frame_conditions.h"

namespace victorious {

inline constexpr int kModelsOfCommonView = 3;  ///< at least

struct CommonView {
  double off_nadir_rad = 0;  ///< in the middle of the frame, as is `pixels_per_m`
  double pixels_per_m = 1;
  double focal_px = 0;  ///< by how much larger objects are further down in the frame
};

/// The view on which the matches of most models agree, within a sixth of the size and 10 degrees. std::nullopt if fewer
/// than three models do so significantly, or if another view has nearly as much.
/// @param matches  of frames spread over a video (ShapeSearch::FindInAnyView)
/// @param size     of the frames, px
[[nodiscard]] std::optional<CommonView> FindCommonView(std::span<const ShapeMatch> matches, const cv::Size& size);

/// The camera with this view; it does not roll.
[[nodiscard]] FrameConditions ConditionsOf(const CommonView& view, const cv::Size& size);

}  // namespace victorious
