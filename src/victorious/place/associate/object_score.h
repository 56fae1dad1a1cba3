// The score of an object: the probability that it is the model it is reported as, from all its sightings.
//
//   score = 1 / (1 + exp(-(w0 + sum_k w_k x_k)))
//
// A sighting's score (search/detect/detect.h) is calibrated for a frame alone. A pattern that looks like the model does
// so in every frame: its sightings are not independent, and their maximum over the frames of an object is near 1
// whether it is right or wrong. The x_k therefore are how much stronger it is than chance, on a flatter curve, and what
// only an object's length shows: a size that contradicts the distance, headings and views that change as no object
// turns. Bias and weight of the strength are fitted by logistic regression to the 32 objects, 8 of them wrong, of
// movies with truth (bench/accuracy/object_scores.py --fit, docs/results/false-alarms.md), rejected ones included. The
// others are chosen: priors of that regression, which so few wrong objects hardly move.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "victorious/place/associate/object_hypothesis.h"

namespace victorious {

/// What is known of one object beside its place.
struct ObjectEvidence {
  /// Natural logarithm of how many times less frequent a false detection as strong is than one an hour of video: the a
  /// contrario test (object_rejection.h).
  double strength = 0;
  double typical_log_odds = 0;    ///< mean over the recognised sightings
  std::int64_t recognitions = 0;  ///< frames in which the search recognised it
  std::int64_t frames = 0;        ///< with a sighting, recognised or tracked
  std::int64_t by_shape = 0;      ///< TrackletSummary
  std::int64_t missed = 0;        ///< TrackletSummary
  /// ObjectPlace::size_ratio of an object that stands.
  std::optional<double> size_ratio;
  std::int64_t lines = 0;          ///< lines of sight
  std::int64_t missing_lines = 0;  ///< those of them that do not meet its place
  std::int64_t headings = 0;
  std::int64_t contradicting_headings = 0;
  std::int64_t view_steps = 0;  ///< TrackletSummary
  std::int64_t view_jumps = 0;
  /// How far the directions of view spread about their mean, one standard deviation of a circular normal distribution.
  /// std::nullopt: fewer than two views.
  std::optional<double> view_spread_rad;
  std::string place_rejected;  ///< ObjectRecord::place_rejected
  /// By which the model's length was found wrong, true over given (length_error.h); 1: it is right.
  double length_factor = 1;
  /// Of a rejected place, or of a wrong length: what it says of the object, by all objects of its flight
  /// (flight_evidence.h).
  double place_weight = 0;
};

/// Of an object whose place is rejected, size, lines and headings say nothing more: they rest on the same telemetry,
/// which may be wrong. `place_weight` is left to the caller, who knows the flight.
/// @param object  with its place, and the reason why that is rejected
/// @param tests   as for IsInsignificant()
[[nodiscard]] ObjectEvidence CollectEvidence(const ObjectHypothesis& hypothesis, const ObjectRecord& object,
                                             double tests, const ObjectOptions& options);

/// The score, 0 to 1.
[[nodiscard]] double ScoreObject(const ObjectEvidence& evidence);

/// What speaks against the object, one reason each, in the order of this list: few or weak recognitions, frames in
/// which its shape was missed, size, lines of sight, headings, views, one side only. Empty if nothing does.
[[nodiscard]] std::vector<std::string> SpeaksAgainst(const ObjectEvidence& evidence);

/// The numbers as a JSON object (ObjectRecord::evidence_json).
[[nodiscard]] std::string ToJsonText(const ObjectEvidence& evidence);

}  // namespace victorious
