// Which chart each triangle lies on, and where each chart lies on the atlas.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "tools/assets_asset.h"

namespace victorious::assets {

inline constexpr int kChartMargin_px = 3;

struct Unwrap {
  std::vector<Chart> charts;
  std::vector<std::vector<int>> chart_of;  ///< [part][triangle]
};

/// A place in a chart's own right and down, m.
cv::Point2f OnChart(const Vec3& point, Side side);
/// The direction a chart looks from.
Vec3 Outward(Side side);
/// Where a part's point lies on the atlas, px, pixel centres at 0.5.
cv::Point2f OnAtlas(const Vec3& point, const Chart& chart);

/// Charts at the greatest scale at which they all fit on a square atlas.
Unwrap UnwrapParts(const std::vector<Part>& parts, int atlas_px);

}  // namespace victorious::assets
