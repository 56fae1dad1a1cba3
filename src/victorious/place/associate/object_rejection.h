// Rejection of places that something contradicts, and of objects that are false alarms (associate_objects.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/place/associate/flight_evidence.h"
#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/object_hypothesis.h"

namespace victorious {

/// Heights, per video, of the objects whose place follows from intersection and not from apparent size only.
class HeightStatistics {
 public:
  void Add(const ObjectHypothesis& hypothesis, double altitude_m);
  /// Returns the median height of each video that has such objects, m. O(n).
  [[nodiscard]] std::map<std::int64_t, double> Medians() const;

 private:
  std::map<std::int64_t, std::vector<double>> of_video_;  // m
};

/// Log odds of the scores of recognised sightings: their sum.
[[nodiscard]] double SumLogOdds(std::span<const double> scores);

/// Two tracklets of CAD models in one video that overlap in some frames: those of different models fill the same pixels
/// (kOcclusionIou), those of one model the same space (same_space.h).
struct TrackletOverlap {
  std::int64_t first = 0;  ///< the smaller id
  std::int64_t second = 0;
  std::int64_t frames = 0;  ///< at least 1
};

/// The overlaps among the tracklets of one video, by id.
/// @param tracklets  by id, with their content
[[nodiscard]] std::vector<TrackletOverlap> FindOverlaps(std::span<const ObservedTracklet* const> tracklets);

[[nodiscard]] bool IsSizeContradicted(const ObjectPlace& estimate, const ObjectOptions& options);

/// Why an estimated place is wrong.
struct PlaceContradiction {
  PlaceFinding finding = PlaceFinding::kImpossible;
  std::string reason;
};

/// std::nullopt: nothing contradicts the place. Wrong telemetry or a wrong length of the model explains a contradiction
/// as a false detection does (flight_evidence.h): the place is rejected, and the object stands or falls by its
/// significance without one and by what the flight says.
/// @param observations  number of bearing observations
[[nodiscard]] std::optional<PlaceContradiction> FindContradiction(const ObjectPlace& estimate, std::size_t observations,
                                                                  const ObjectOptions& options);

/// Removes the place, and the heading, which rests on the same telemetry.
void RejectPlace(std::string reason, ObjectRecord& object);

/// What it says that an object found by shape was found again, or missed, in the frames in which its shape was searched
/// for where it was tracked to: the natural logarithm of how much more probable that is of the object than of something
/// else (docs/adr/0047). 0 where most was found by keypoints.
[[nodiscard]] double FoundAgainLogOdds(const ObjectHypothesis& hypothesis);

/// What the size of an object found by shape says: the logarithm of the ratio of its distance by intersection to its
/// range by apparent size has the error of the intersection, of the size in the frames, and of the model's length if it
/// is this object; that of another one that is taken for it spreads by 3 % in addition (docs/adr/0047). The natural
/// logarithm of the ratio of the two densities; 0 where most was found by keypoints, the size is not known, or the
/// model's length was corrected by it.
[[nodiscard]] double SizeLogOdds(const ObjectHypothesis& hypothesis);

/// Natural logarithm of one over the number of false detections as strong that are expected by chance.
/// @param placed, tests  as for IsInsignificant()
[[nodiscard]] double StrengthOf(const ObjectHypothesis& hypothesis, bool placed, double tests,
                                const ObjectOptions& options);

/// The a contrario test: true if as strong a false detection is expected by chance.
/// @param placed           false: the object has no place, and the test rests on recognition alone
/// @param tests            their number (SearchCounts::TestsOf)
/// @param finding_weight   what the place says of the object (WeighFindings); positive ones do not count
[[nodiscard]] bool IsInsignificant(const ObjectHypothesis& hypothesis, bool placed, double tests,
                                   const ObjectOptions& options, double finding_weight = 0);

/// The contradiction of a place whose height follows from its size only and is far from the median height.
/// @param median_heights_m  of each video (HeightStatistics::Medians)
[[nodiscard]] std::optional<PlaceContradiction> FindFloating(const ObjectHypothesis& hypothesis,
                                                             const std::map<std::int64_t, double>& median_heights_m,
                                                             const ObjectOptions& options, const ObjectRecord& object);

/// Rejects the less-observed of two CAD objects of different models in the same pixels, where one would occlude the
/// other, and of two of one model in the same space the one with less evidence (sum of the log odds of its scores): if
/// they overlap in half of its frames.
/// @param tracklets    of all objects, by id
/// @param overlaps     of all tracklets
/// @param constraints  objects between which a cannot-link stands are two, whatever they overlap
void RejectOverlapping(std::vector<ObjectRecord>& objects,
                       const std::map<std::int64_t, const ObservedTracklet*>& tracklets,
                       std::span<const TrackletOverlap> overlaps, const LinkConstraints& constraints);

/// Rejects the less-observed of two coincident static objects.
/// @param tracklets    of all objects, by id
/// @param constraints  likewise
void RejectCoincident(std::vector<ObjectRecord>& objects,
                      const std::map<std::int64_t, const ObservedTracklet*>& tracklets,
                      const LinkConstraints& constraints);

}  // namespace victorious
