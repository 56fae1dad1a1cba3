#include "victorious/place/associate/object_rejection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/place/associate/place_grid.h"
#include "victorious/place/associate/same_space.h"
#include "victorious/types/ground_motion.h"

namespace victorious {
namespace {

// Number of frames in which another tracklet covers the same pixels (intersection over union).
std::int64_t CountOverlappingFrames(const ObservedTracklet& tracklet, const ObservedTracklet& by, double min_overlap) {
  if (tracklet.record.video != by.record.video) return 0;
  std::int64_t covered = 0;
  auto other = by.frames.begin();
  for (std::size_t i = 0; i < tracklet.frames.size(); ++i) {
    other = std::lower_bound(other, by.frames.end(), tracklet.frames[i]);
    if (other == by.frames.end()) break;
    if (*other != tracklet.frames[i]) continue;
    const Box& box = by.boxes[static_cast<std::size_t>(other - by.frames.begin())];
    if (IntersectionOverUnion(tracklet.boxes[i], box) >= min_overlap) ++covered;
  }
  return covered;
}

// Number of frames in which two tracklets of one model are in the same space.
std::int64_t CountFramesInSameSpace(const ObservedTracklet& first, const ObservedTracklet& second) {
  const auto box_in = [](const ObservedTracklet& tracklet, std::int64_t frame) {
    const auto at = std::ranges::lower_bound(tracklet.frames, frame);
    return tracklet.boxes[static_cast<std::size_t>(at - tracklet.frames.begin())];
  };
  std::int64_t frames = 0;
  auto other = second.observation_frames.begin();
  for (std::size_t i = 0; i < first.observation_frames.size(); ++i) {
    const std::int64_t frame = first.observation_frames[i];
    other = std::lower_bound(other, second.observation_frames.end(), frame);
    if (other == second.observation_frames.end()) break;
    if (*other != frame) continue;
    const auto j = static_cast<std::size_t>(other - second.observation_frames.begin());
    if (AreInSameSpace(first.observations[i], box_in(first, frame), second.observations[j], box_in(second, frame)))
      ++frames;
  }
  return frames;
}

std::int64_t CountObjectFrames(const ObjectRecord& object,
                               const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  std::int64_t frames = 0;
  for (const std::int64_t tracklet : object.tracklets) frames += tracklets.at(tracklet)->record.frames;
  return frames;
}

// True if `a` has more frames; ties go to the smaller id, the object seen first.
bool HasMoreFrames(const ObjectRecord& a, const ObjectRecord& b,
                   const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  return std::pair(CountObjectFrames(a, tracklets), -a.id) > std::pair(CountObjectFrames(b, tracklets), -b.id);
}

double SumEvidence(const ObjectRecord& object, const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  double log_odds = 0;
  for (const std::int64_t tracklet : object.tracklets) log_odds += tracklets.at(tracklet)->summary.log_odds;
  return log_odds;
}

// Which of two reports of one model in the same space is true: the one with more evidence, of equals that with more
// frames. The false one may be seen in more frames, where the true one was lost.
bool HasMoreEvidence(const ObjectRecord& a, const ObjectRecord& b,
                     const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  const double of_a = SumEvidence(a, tracklets);
  const double of_b = SumEvidence(b, tracklets);
  return of_a != of_b ? of_a > of_b : HasMoreFrames(a, b, tracklets);
}

// Scores beyond it, and below its complement, have the log odds of it: they stay finite.
constexpr double kMaxScore = 1 - 1e-12;

double LogOdds(double score) {
  const double probability = std::clamp(score, 1 - kMaxScore, kMaxScore);
  return std::log(probability / (1 - probability));
}

// A contrario test. A score p is the probability that a detection is right if there is an object, with odds p / (1 -
// p). The expected number of false detections with odds above x is about 1/x of that with even odds (`false_alarm_rate`
// per frame and model), and they last one frame. An object in n consistent frames is therefore n times less likely to
// be false. Its odds are those of a typical frame, exp(mean of the log odds): the maximum over n frames would be
// biased. Frames between recognitions are tracked: they say that something stays there, not what, and up to
// kFramesOfRecognition count for each recognition (at 30 frames a second two of three are interpolated). The strength
// is the logarithm of one over the expected number of false objects as strong.
//
// kMaxFalseAlarms: maximum expected number of false detections as strong, an hour of video (search_counts.h). Chosen:
// one hour in ten has one.
constexpr double kMaxFalseAlarms = 0.1;
constexpr double kFramesOfRecognition = 4;

// Of an object, over its tracklets.
struct ShapeFinds {
  std::int64_t recognitions = 0;  // by any cue
  std::int64_t found = 0;         // those of them that were found by shape
  std::int64_t missed = 0;

  [[nodiscard]] bool AreMost() const { return 2 * found > recognitions; }
};

ShapeFinds CountShapeFinds(const ObjectHypothesis& hypothesis) {
  ShapeFinds finds;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    finds.recognitions += tracklet->summary.recognitions;
    finds.found += tracklet->summary.by_shape;
    finds.missed += tracklet->summary.missed;
  }
  return finds;
}

struct SignificanceTest {
  double log_odds = 0;  // of a typical frame
  double frames = 0;    // that are consistent
  double false_alarms_at_even_odds = 0;
};

SignificanceTest TestOf(const ObjectHypothesis& hypothesis, bool placed, double tests, const ObjectOptions& options) {
  SignificanceTest test;
  double recognised = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    test.frames += static_cast<double>(tracklet->record.frames);
    test.log_odds += tracklet->summary.log_odds;
    recognised += static_cast<double>(tracklet->summary.recognitions);
  }
  if (recognised > 0) test.log_odds /= recognised;
  test.log_odds += FoundAgainLogOdds(hypothesis);
  test.frames = std::min(test.frames, kFramesOfRecognition * recognised);
  if (placed) {
    test.frames = std::max(1.0, test.frames * hypothesis.estimate.consistent_fraction);
    test.log_odds += SizeLogOdds(hypothesis);
  }
  test.false_alarms_at_even_odds = options.false_alarm_rate * tests;
  return test;
}

// The lowest land is the shore of the Dead Sea, about 440 m below sea level; a place is below any ground if it is so by
// two standard deviations.
constexpr double kLowestGround_m = -500;
constexpr double kBelowGroundSigmas = 2;

bool IsBelowLowestGround(const Geolocation& place) {
  return place.point.altitude_m + kBelowGroundSigmas * std::sqrt(place.covariance_enu_m2(2, 2)) < kLowestGround_m;
}

// Fewer lines of sight than this are not rejected for not intersecting: two always have a nearest point.
constexpr std::size_t kMinObservations = 3;

std::string SizeReason(double size_ratio) {
  return size_ratio > 1 ? fmt::format("{:.1f} times too large for its distance", size_ratio)
                        : fmt::format("{:.1f} times too small for its distance", 1 / size_ratio);
}

// What drives, sails or flies moves along its heading, or backwards. A helicopter may slip sideways, not for long.
std::optional<std::string> AcrossReason(const ObjectPlace& estimate) {
  constexpr double kMaxSlip_rad = RadiansFromDegrees(30);
  constexpr double kSigmas = 2;
  constexpr std::int64_t kMinHeadings = 3;
  if (!estimate.HasPath() || !estimate.place || !estimate.heading_rad || estimate.headings < kMinHeadings)
    return std::nullopt;
  const std::optional<GroundMotion> motion = ComputeGroundMotion(*estimate.place);
  if (!motion) return std::nullopt;
  const double off_rad = std::abs(WrapAngle(motion->course_rad - *estimate.heading_rad));
  const double slip_rad = std::min(off_rad, kPi - off_rad);
  if (slip_rad <= kMaxSlip_rad + kSigmas * motion->sigma_course_rad) return std::nullopt;
  return fmt::format("it would move at {:.0f} m/s, {:.0f} degrees off its heading", motion->speed_m_s,
                     DegreesFromRadians(slip_rad));
}

}  // namespace

void HeightStatistics::Add(const ObjectHypothesis& hypothesis, double altitude_m) {
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) of_video_[tracklet->record.video].push_back(altitude_m);
}

std::map<std::int64_t, double> HeightStatistics::Medians() const {
  std::map<std::int64_t, double> medians_m;
  for (const auto& [video, heights_m] : of_video_) medians_m[video] = Median(heights_m);
  return medians_m;
}

bool IsSizeContradicted(const ObjectPlace& estimate, const ObjectOptions& options) {
  const double ratio = estimate.size_ratio.value_or(1);
  return ratio > options.max_size_ratio || ratio < 1 / options.max_size_ratio;
}

std::optional<PlaceContradiction> FindContradiction(const ObjectPlace& estimate, std::size_t observations,
                                                    const ObjectOptions& options) {
  if (estimate.place && IsBelowLowestGround(*estimate.place)) {
    return PlaceContradiction{PlaceFinding::kImpossible, fmt::format("{:.0f} m below the sea, below any ground",
                                                                     -estimate.place->point.altitude_m)};
  }
  // An object that drives is placed by its size: the distance of its lines, as if it stood still, contradicts nothing.
  if (!estimate.HasPath() && IsSizeContradicted(estimate, options))
    return PlaceContradiction{PlaceFinding::kImpossible, SizeReason(*estimate.size_ratio)};
  if (std::optional<std::string> reason = AcrossReason(estimate))
    return PlaceContradiction{PlaceFinding::kImpossible, *std::move(reason)};
  if (observations >= kMinObservations && estimate.inlier_fraction < options.min_inlier_fraction)
    return PlaceContradiction{PlaceFinding::kNoIntersection, "its lines of sight do not intersect"};
  return std::nullopt;
}

void RejectPlace(std::string reason, ObjectRecord& object) {
  object.place_rejected = std::move(reason);
  object.place.reset();
  object.heading_rad.reset();
}

// The beta-binomial probabilities of k finds and m misses, of true objects over those of false ones. How often a
// shape is found again differs from object to object, not from frame to frame: a beta distribution for each of the two.
// Chosen on bench/accuracy/plain_vehicles.py: true objects are hardly missed (with 15 % of noise, too; one of 70
// in three frames of 15), false ones in half of the frames, those on one side of them. More is not made of it, as other
// video may hide objects more often.
double FoundAgainLogOdds(const ObjectHypothesis& hypothesis) {
  constexpr double kTrueFound = 6;
  constexpr double kTrueMissed = 0.4;
  constexpr double kFalseFound = 2;
  constexpr double kFalseMissed = 2;
  constexpr double kMin = -4;
  constexpr double kMax = 1.5;
  const ShapeFinds shape = CountShapeFinds(hypothesis);
  if (!shape.AreMost()) return 0;
  const auto log_beta = [](double a, double b) { return std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b); };
  const auto log_probability = [&](double found, double not_found) {
    const auto again = static_cast<double>(shape.found - 1);  // what is found for the first time was not searched for
    return log_beta(found + again, not_found + static_cast<double>(shape.missed)) - log_beta(found, not_found);
  };
  return std::clamp(log_probability(kTrueFound, kTrueMissed) - log_probability(kFalseFound, kFalseMissed), kMin, kMax);
}

double SizeLogOdds(const ObjectHypothesis& hypothesis) {
  constexpr double kSizeError_px = 0.5;
  constexpr double kLengthError = 0.01;  // of models
  constexpr double kOtherSizes = 0.03;
  constexpr double kMin = -4;
  double size_px = std::numeric_limits<double>::infinity();
  bool is_length_wrong = false;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    size_px = std::min(size_px, tracklet->summary.size_px);
    is_length_wrong = is_length_wrong || tracklet->length_factor != 1;
  }
  const ObjectPlace& estimate = hypothesis.estimate;
  if (!estimate.size_ratio || estimate.HasPath() || is_length_wrong) return 0;
  if (!CountShapeFinds(hypothesis).AreMost() || !(size_px > 0)) return 0;
  const double sigma = std::hypot(kLengthError, kSizeError_px / size_px, estimate.size_sigma);
  const double of_others = std::hypot(sigma, kOtherSizes);
  const double deviation = std::log(*estimate.size_ratio);
  const double squares = deviation * deviation * (1 / (sigma * sigma) - 1 / (of_others * of_others));
  return std::max(kMin, std::log(of_others / sigma) - squares / 2);
}

double StrengthOf(const ObjectHypothesis& hypothesis, bool placed, double tests, const ObjectOptions& options) {
  constexpr double kMin = 1e-9;  // nothing was searched, or no false alarms are expected
  const SignificanceTest test = TestOf(hypothesis, placed, tests, options);
  return test.log_odds + std::log(std::max(test.frames, kMin)) -
         std::log(std::max(test.false_alarms_at_even_odds, kMin));
}

bool IsInsignificant(const ObjectHypothesis& hypothesis, bool placed, double tests, const ObjectOptions& options,
                     double finding_weight) {
  const SignificanceTest test = TestOf(hypothesis, placed, tests, options);
  const double odds = std::exp(test.log_odds + std::min(finding_weight, 0.0));
  return odds * test.frames * kMaxFalseAlarms < test.false_alarms_at_even_odds;
}

// If a place of another size fits its lines, the object does not drive at that height, but stands and is of that size.
std::optional<PlaceContradiction> FindFloating(const ObjectHypothesis& hypothesis,
                                               const std::map<std::int64_t, double>& median_heights_m,
                                               const ObjectOptions& options, const ObjectRecord& object) {
  const ObjectPlace& estimate = hypothesis.estimate;
  const bool other_size = estimate.HasPath() && IsSizeContradicted(estimate, options);
  if ((estimate.size_ratio && !other_size) || !object.place || !object.rejected.empty() ||
      hypothesis.tracklets[0]->is_category)
    return std::nullopt;
  const auto median = median_heights_m.find(hypothesis.tracklets[0]->record.video);
  if (median == median_heights_m.end()) return std::nullopt;
  const double above_m = object.place->point.altitude_m - median->second;
  if (std::abs(above_m) < options.max_height_deviation_m) return std::nullopt;
  if (other_size) return PlaceContradiction{PlaceFinding::kImpossible, SizeReason(*estimate.size_ratio)};
  return PlaceContradiction{above_m > 0 ? PlaceFinding::kAbove : PlaceFinding::kImpossible,
                            fmt::format("{:.0f} m {} the other objects, judged by its size only", std::abs(above_m),
                                        above_m > 0 ? "above" : "below")};
}

double SumLogOdds(std::span<const double> scores) {
  double sum = 0;
  for (const double score : scores) sum += LogOdds(score);
  return sum;
}

std::vector<TrackletOverlap> FindOverlaps(std::span<const ObservedTracklet* const> tracklets) {
  std::vector<TrackletOverlap> overlaps;
  for (const ObservedTracklet* first : tracklets) {
    if (!first->is_cad_model || first->frames.empty()) continue;
    for (const ObservedTracklet* second : tracklets) {
      if (second->record.id <= first->record.id || !second->is_cad_model || second->frames.empty()) continue;
      if (second->frames.front() > first->frames.back() || first->frames.front() > second->frames.back()) continue;
      const std::int64_t frames = second->record.model == first->record.model
                                      ? CountFramesInSameSpace(*first, *second)
                                      : CountOverlappingFrames(*first, *second, kOcclusionIou);
      if (frames > 0) overlaps.push_back({first->record.id, second->record.id, frames});
    }
  }
  return overlaps;
}

void RejectOverlapping(std::vector<ObjectRecord>& objects,
                       const std::map<std::int64_t, const ObservedTracklet*>& tracklets,
                       std::span<const TrackletOverlap> overlaps, const LinkConstraints& constraints) {
  if (overlaps.empty()) return;
  std::map<std::int64_t, std::vector<const TrackletOverlap*>> of_tracklet;
  std::map<std::int64_t, std::size_t> object_of;  // indices into `objects`, by tracklet that overlaps another
  for (const TrackletOverlap& overlap : overlaps) {
    of_tracklet[overlap.first].push_back(&overlap);
    of_tracklet[overlap.second].push_back(&overlap);
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (const std::int64_t tracklet : objects[i].tracklets) {
      if (of_tracklet.contains(tracklet)) object_of[tracklet] = i;
    }
  }
  for (ObjectRecord& less : objects) {
    if (!less.rejected.empty() || !tracklets.at(less.id)->is_cad_model) continue;
    std::map<std::size_t, std::int64_t> covered;  // frames, by the object that covers them
    for (const std::int64_t tracklet : less.tracklets) {
      const auto found = of_tracklet.find(tracklet);
      if (found == of_tracklet.end()) continue;
      for (const TrackletOverlap* overlap : found->second) {
        const auto by = object_of.find(overlap->first == tracklet ? overlap->second : overlap->first);
        if (by != object_of.end()) covered[by->second] += overlap->frames;
      }
    }
    for (const auto& [other, frames] : covered) {
      const ObjectRecord& more = objects[other];
      const bool is_same_model = more.model == less.model;
      if (!more.rejected.empty()) continue;
      if (is_same_model ? !HasMoreEvidence(more, less, tracklets) : !HasMoreFrames(more, less, tracklets)) continue;
      if (2 * frames < CountObjectFrames(less, tracklets)) continue;
      if (constraints.CannotLink(more.tracklets, less.tracklets)) continue;
      less.rejected = fmt::format("in the same {} as object {}", is_same_model ? "space" : "pixels", more.id);
      break;
    }
  }
}

void RejectCoincident(std::vector<ObjectRecord>& objects,
                      const std::map<std::int64_t, const ObservedTracklet*>& tracklets,
                      const LinkConstraints& constraints) {
  PlaceGrid grid(kMinSeparation_m);  // indices into `objects`
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].place) grid.Add(objects[i].place->point, static_cast<std::int64_t>(i));
  }
  for (ObjectRecord& less : objects) {
    if (!less.place || !less.rejected.empty() || tracklets.at(less.id)->is_category) continue;
    const TangentPlane plane(less.place->point);
    for (const std::int64_t other : grid.Near(less.place->point)) {
      const ObjectRecord& more = objects[static_cast<std::size_t>(other)];
      if (!more.place || !more.rejected.empty() || more.id == less.id || tracklets.at(more.id)->is_category) continue;
      if (!HasMoreFrames(more, less, tracklets)) continue;
      if (less.place->IsMoving() || more.place->IsMoving()) continue;
      if (plane.EnuFromGeodetic(more.place->point).norm() >= kMinSeparation_m) continue;
      if (constraints.CannotLink(more.tracklets, less.tracklets)) continue;
      less.rejected = fmt::format("at the same place as object {}", more.id);
      break;
    }
  }
}

}  // namespace victorious
