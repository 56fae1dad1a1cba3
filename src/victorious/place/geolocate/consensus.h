// RANSAC over lines of sight (thesis, section 4.3.3): finds the place that lies in the conic frusta of the largest
// number of rays. Called by locate.h for the methods `ransac` and `ml`.
//
// A hypothesis is the linear solution (linear_place.h) of two rays, or of three if the object moves. Its cost is that
// of MSAC (Torr and Zisserman 2000), summed over all rays: the squared distance from the ray divided by the squared
// frustum radius there, truncated to 1 outside the frustum. Each hypothesis that improves on the best one is refitted
// to its own inliers while the cost falls (LO-RANSAC; Chum, Matas, Kittler 2003). The evaluation of a hypothesis stops
// as soon as its cost exceeds the best one.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/place/geolocate/locate_options.h"
#include "victorious/place/geolocate/ray.h"

namespace victorious {

struct Consensus {
  Motion motion;
  std::vector<bool> inliers;  ///< one per ray
  int hypotheses = 0;         ///< number of hypotheses drawn
};

/// Returns std::nullopt if no sample lies in the frusta of its own rays. `rays` must not be empty. Deterministic for a
/// given `options.seed`.
std::optional<Consensus> FindConsensus(std::span<const Ray> rays, const LocateOptions& options);

}  // namespace victorious
