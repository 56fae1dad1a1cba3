// RANSAC over lines of sight (thesis, section 4.3.3): the place that lies in most rays' conic frusta.
//
// A hypothesis is the linear solution of two rays (three where the object moves). Its cost is MSAC's (Torr and
// Zisserman 2000): over all rays, the squared distance from the ray over the frustum's squared radius there, or 1
// outside. Each hypothesis that beats the best is refitted to its own inliers while that helps (Chum, Matas, Kittler
// 2003). A hypothesis is given up as soon as its cost exceeds the best.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/geolocate/locate_options.h"
#include "victorious/geolocate/ray.h"

namespace victorious {

struct Consensus {
  Motion motion;
  std::vector<bool> inliers;  ///< one a ray
  int hypotheses = 0;         ///< drawn
};

/// Nothing where no sample lies in its own rays' frusta. At least one ray.
std::optional<Consensus> FindConsensus(std::span<const Ray> rays, const LocateOptions& options);

}  // namespace victorious
