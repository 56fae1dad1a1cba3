// The factor by which all ranges of a flight are wrong, as by a wrong field of view: ranges by apparent size are
// proportional to the focal length, while lines of sight from a camera that circles meet at the true distance.
//
// One object whose size contradicts its distance drives, or is of another size. If several different objects are
// contradicted by the same factor, and more than agree with their sizes, the common cause is the camera.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

struct RangeFactor {
  double factor = 1;  ///< true range over given range
  int objects = 0;    ///< tracklets that agree on it
};

/// EstimateSizeRatio of a tracklet; std::nullopt if it has too few observations to be compared.
using RangeComparison = std::optional<std::optional<SizeRatio>>;

/// Compares the ranges of each tracklet with the intersection of its lines of sight.
[[nodiscard]] std::vector<RangeComparison> CompareRanges(std::span<const ObservedTracklet> tracklets,
                                                         const ObjectOptions& options);

/// Estimates the factor of one flight; std::nullopt without a common error. Only factors up to 1.28 either way: larger
/// ones are another model's size.
/// @param tracklets    of one video; those with ranges whose lines determine the distance to a few per cent count
/// @param comparisons  CompareRanges of them
[[nodiscard]] std::optional<RangeFactor> EstimateRangeFactor(std::span<const ObservedTracklet> tracklets,
                                                             std::span<const RangeComparison> comparisons);

/// Multiplies the ranges of a tracklet by a factor.
void ScaleRanges(double factor, ObservedTracklet& tracklet);

}  // namespace victorious
