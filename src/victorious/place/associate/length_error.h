// Models whose length is wrong, as of CAD files in feet or inches: their ranges by apparent size are wrong by one
// factor.
//
// The place of an object at P, seen from C(t) with ranges that are k times too large, is
//
//   C(t) + k (P - C(t)) = k P + (1 - k) C(t)
//
// It drives along the camera's own path, with 1 - k of its velocity, while its lines of sight meet in one point. An
// object that really drives so along a straight flight looks the same, so that two more things decide: no vehicle
// drives across its own heading, or turns exactly when the camera does; and one of the two places is at the height of
// the ground, or of objects of other models.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "victorious/place/associate/object_options.h"
#include "victorious/place/associate/observed_tracklet.h"
#include "victorious/place/associate/range_factor.h"

namespace victorious {

/// Smaller errors are those of sizes and cameras; with larger ones the object is rather a false find.
inline constexpr double kMinLengthFactor = 1.28;
inline constexpr double kMaxLengthFactor = 4;

struct LengthError {
  std::int64_t model = 0;
  double factor = 1;  ///< true length over given length
  int objects = 0;    ///< tracklets that agree on it
};

/// Finds the CAD models all of whose tracklets agree on one factor of the length, between kMinLengthFactor and
/// kMaxLengthFactor or their inverses, by which they stand still, and which cannot drive instead.
/// @param tracklets    of one video, with their content
/// @param comparisons  CompareRanges of them
/// @return by model
[[nodiscard]] std::vector<LengthError> FindLengthErrors(std::span<const ObservedTracklet> tracklets,
                                                        std::span<const RangeComparison> comparisons,
                                                        const ObjectOptions& options);

/// The factor of a model; 1 if its length is not known to be wrong.
[[nodiscard]] double LengthFactorOf(std::span<const LengthError> errors, std::int64_t model);

/// What a wrong length means for an object of the model, in words. @param factor  true length over given, not 1
[[nodiscard]] std::string DescribeLengthFactor(double factor);

/// Multiplies the ranges of these models' tracklets by their factors.
void CorrectLengths(std::span<const LengthError> errors, std::span<ObservedTracklet> tracklets);

}  // namespace victorious
