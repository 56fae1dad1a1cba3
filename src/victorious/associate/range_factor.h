// The factor by which all ranges of a flight are wrong, as by a wrong field of view: ranges by apparent size are
// proportional to the focal length, while lines of sight from a camera that circles meet at the true distance.
//
// One object whose size contradicts its distance drives, or is of another size. If several different objects are
// contradicted by the same factor, and more than agree with their sizes, the common cause is the camera.
#pragma once

#include <optional>
#include <span>

#include "victorious/associate/associate_objects.h"
#include "victorious/associate/object_options.h"

namespace victorious {

struct RangeFactor {
  double factor = 1;  ///< true range over given range
  int objects = 0;    ///< tracklets that agree on it
};

/// Estimates the factor of one flight; std::nullopt without a common error. Only factors up to 1.28 either way: larger
/// ones are another model's size.
/// @param tracklets  of one video; those with ranges whose lines determine the distance to a few per cent count
std::optional<RangeFactor> EstimateRangeFactor(std::span<const ObservedTracklet> tracklets,
                                               const ObjectOptions& options);

/// Multiplies the ranges of the tracklets by the factor.
void ScaleRanges(const RangeFactor& factor, std::span<ObservedTracklet> tracklets);

}  // namespace victorious
