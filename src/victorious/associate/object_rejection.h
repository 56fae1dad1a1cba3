// Rejection of places that something contradicts, and of objects that are false alarms (associate_objects.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "victorious/associate/object_hypothesis.h"

namespace victorious {

/// Median height, per video, of the objects whose place follows from intersection and not from apparent size only.
class HeightStatistics {
 public:
  void Add(const ObjectHypothesis& hypothesis, double altitude_m);
  [[nodiscard]] std::optional<double> MedianHeight(const ObjectHypothesis& hypothesis) const;

 private:
  std::map<std::int64_t, std::vector<double>> of_video_;  // m
};

[[nodiscard]] bool IsSizeContradicted(const ObjectPlace& estimate, const ObjectOptions& options);

/// The reason why an estimated place is wrong; empty if nothing contradicts it. Wrong telemetry is as good an
/// explanation as a false detection: the place is rejected, and the object stands or falls by its significance without
/// one.
/// @param observations  number of bearing observations
[[nodiscard]] std::string PlaceRejectionReason(const ObjectPlace& estimate, std::size_t observations,
                                               const ObjectOptions& options);

/// Removes the place, and the heading, which rests on the same telemetry.
void RejectPlace(std::string reason, ObjectRecord& object);

/// The a contrario test: true if as strong a false detection is expected by chance.
/// @param placed           false: the object has no place, and the test rests on recognition alone
/// @param frames_searched  number of tests
[[nodiscard]] bool IsInsignificant(const ObjectHypothesis& hypothesis, bool placed, std::int64_t frames_searched,
                                   const ObjectOptions& options);

/// Rejects the place of an object whose height follows from its size only and is far from the median height.
void RejectFloating(const ObjectHypothesis& hypothesis, const HeightStatistics& heights, const ObjectOptions& options,
                    ObjectRecord& object);

/// Rejects the less-observed of two CAD objects in the same pixels: one would occlude the other.
/// @param tracklets  of all objects, by id
void RejectOccluded(std::vector<ObjectRecord>& objects,
                    const std::map<std::int64_t, const ObservedTracklet*>& tracklets);

/// Rejects the less-observed of two coincident static objects.
/// @param tracklets  of all objects, by id
void RejectCoincident(std::vector<ObjectRecord>& objects,
                      const std::map<std::int64_t, const ObservedTracklet*>& tracklets);

}  // namespace victorious
