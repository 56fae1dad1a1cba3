// tools/: texture unwrapping: the chart of each triangle, and the position of each chart on the atlas.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "assets/make/asset.h"

namespace victorious::assets {

inline constexpr int kChartMargin_px = 3;

struct Unwrap {
  std::vector<Chart> charts;
  std::vector<std::vector<int>> triangle_charts;  ///< [part][triangle]
};

/// A point in a chart's right and down axes, m.
cv::Point2f ProjectToChart(const Vec3& point, Side side);
/// The unit vector from the model towards the viewpoint of a chart.
Vec3 Outward(Side side);
/// A part's point on the atlas, px, pixel centres at 0.5.
cv::Point2f ProjectToAtlas(const Vec3& point, const Chart& chart);

/// Packs the charts at the maximum scale at which all fit on a square atlas.
Unwrap UnwrapParts(const std::vector<Part>& parts, int atlas_px);

}  // namespace victorious::assets
