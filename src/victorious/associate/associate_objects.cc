#include "victorious/associate/associate_objects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "victorious/associate/fits.h"
#include "victorious/associate/object_hypothesis.h"
#include "victorious/associate/object_rejection.h"
#include "victorious/associate/object_score.h"

namespace victorious {
namespace {

// Standard deviations of the heights of objects' centres above the ground (a car, an aircraft), and of the ground's
// slope. Chosen, not fitted.
constexpr double kCentreHeightSpread_m = 1;
constexpr double kSlope = 0.03;

// The weighted median over the other objects of the flight, which a flying one does not move.
std::optional<Level> LevelUnder(const ObjectHypothesis& driving, std::span<const ObjectHypothesis* const> of_its_flight,
                                const ObjectOptions& options) {
  struct Sample {
    double altitude_m;
    double weight;
  };
  std::vector<Sample> samples;
  double total = 0;
  const TangentPlane plane(driving.estimate.place->point);
  for (const ObjectHypothesis* other : of_its_flight) {
    const ObjectPlace& estimate = other->estimate;
    if (other == &driving || !estimate.place || other->tracklets[0]->is_category) continue;
    if (estimate.inlier_fraction < options.min_inlier_fraction) continue;
    const bool drives = estimate.HasPath();
    if (!drives && (!estimate.size_ratio || IsSizeContradicted(estimate, options))) continue;
    const Geolocation& place = *estimate.place;
    const double slope_m = kSlope * plane.EnuFromGeodetic(place.point).head<2>().norm();
    const double variance_m2 =
        place.covariance_enu_m2(2, 2) + kCentreHeightSpread_m * kCentreHeightSpread_m + slope_m * slope_m;
    samples.push_back({place.point.altitude_m, 1 / variance_m2});
    total += samples.back().weight;
  }
  if (samples.empty()) return std::nullopt;
  std::ranges::sort(samples, {}, &Sample::altitude_m);
  double below = 0;
  for (const Sample& sample : samples) {
    below += sample.weight;
    if (below >= total / 2) return Level{sample.altitude_m, 1 / std::sqrt(total)};
  }
  return Level{samples.back().altitude_m, 1 / std::sqrt(total)};
}

// The absolute place: the relative one of the flight with its full common errors, which are those of `absolute` beyond
// those of `relative`.
Geolocation WithCommonErrors(Geolocation place, const Geolocation& relative, const Geolocation& absolute) {
  place.covariance_enu_m2 += absolute.covariance_enu_m2 - relative.covariance_enu_m2;
  if (Eigen::LLT<Eigen::Matrix3d>(place.covariance_enu_m2).info() != Eigen::Success)
    place.covariance_enu_m2 = absolute.covariance_enu_m2;
  return PropagatePlace(place, place.time_s);
}

// The final estimate. An object that drives is placed on the ground that the other objects of its flight show, unless
// the ground is given: its height then fixes the distance better than its size.
ObjectPlace EstimateFinalPlace(ObjectHypothesis& hypothesis, std::span<const ObjectHypothesis* const> of_its_flight,
                               Fits& fits) {
  ObjectPlace estimate = AbsolutePlace(hypothesis, fits);
  const ObjectPlace& relative = hypothesis.estimate;
  if (fits.options().ground || !estimate.HasPath() || relative.path_size != estimate.path_size) return estimate;
  const std::optional<Level> level = LevelUnder(hypothesis, of_its_flight, fits.options());
  if (!level) return estimate;
  const ObjectPlace placed = fits.OnLevel(hypothesis, *level);
  if (placed.path_size != estimate.path_size) return estimate;
  estimate.place = WithCommonErrors(*placed.place, *relative.place, *estimate.place);
  return estimate;
}

std::size_t CountObservations(const ObjectHypothesis& hypothesis) {
  std::int64_t observations = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) observations += tracklet->summary.observations;
  return static_cast<std::size_t>(observations);
}

// The hypotheses by their flight; those of several flights belong to none.
std::map<std::int64_t, std::vector<const ObjectHypothesis*>> ByFlight(const std::vector<ObjectHypothesis>& hypotheses) {
  std::map<std::int64_t, std::vector<const ObjectHypothesis*>> of_flight;
  for (const ObjectHypothesis& hypothesis : hypotheses) {
    if (IsInOneVideo(hypothesis)) of_flight[hypothesis.tracklets[0]->record.video].push_back(&hypothesis);
  }
  return of_flight;
}

void Score(const ObjectHypothesis& hypothesis, double tests, const ObjectOptions& options, ObjectRecord& object) {
  if (hypothesis.tracklets[0]->is_category) return;  // its score is the classifier's
  const ObjectEvidence evidence = CollectEvidence(hypothesis, object, tests, options);
  object.object_score = ScoreObject(evidence);
  object.against = SpeaksAgainst(evidence);
  object.evidence_json = ToJsonText(evidence);
}

}  // namespace

std::vector<ObjectRecord> AssociateTracklets(std::span<const ObservedTracklet* const> tracklets,
                                             std::span<const TrackletOverlap> overlaps, const SearchCounts& searches,
                                             Fits& fits) {
  const ObjectOptions& options = fits.options();
  std::map<std::int64_t, const ObservedTracklet*> by_id;
  std::map<std::int64_t, std::vector<const ObservedTracklet*>> of_model;
  for (const ObservedTracklet* tracklet : tracklets) {
    by_id.emplace_hint(by_id.end(), tracklet->record.id, tracklet);
    of_model[tracklet->record.model].push_back(tracklet);
  }
  std::vector<ObjectHypothesis> hypotheses;
  for (const auto& [model, of_one] : of_model)
    std::ranges::move(MergeTracklets(of_one, fits), std::back_inserter(hypotheses));

  std::vector<ObjectRecord> objects;
  HeightStatistics heights;
  std::vector<ObjectPlace> estimates;
  const auto of_flight = ByFlight(hypotheses);
  for (ObjectHypothesis& hypothesis : hypotheses) {
    const auto others = of_flight.find(hypothesis.tracklets[0]->record.video);
    estimates.push_back(EstimateFinalPlace(
        hypothesis, others != of_flight.end() ? std::span(others->second) : std::span<const ObjectHypothesis* const>(),
        fits));
  }
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    ObjectHypothesis& hypothesis = hypotheses[i];
    hypothesis.estimate = std::move(estimates[i]);
    ObjectRecord object{.id = hypothesis.tracklets[0]->record.id,
                        .model = hypothesis.tracklets[0]->record.model,
                        .place = hypothesis.estimate.place,
                        .heading_rad = hypothesis.estimate.heading_rad};
    for (const ObservedTracklet* tracklet : hypothesis.tracklets) object.tracklets.push_back(tracklet->record.id);
    std::string reason = PlaceRejectionReason(hypothesis.estimate, CountObservations(hypothesis), options);
    if (!reason.empty()) RejectPlace(std::move(reason), object);
    if (!hypothesis.tracklets[0]->is_category &&
        IsInsignificant(hypothesis, object.place.has_value(), searches.TestsOf(hypothesis), options)) {
      object.rejected = fmt::format(
          "not significant: as strong a false detection is expected by chance in {:.0f} frames of one model",
          searches.TestsOf(hypothesis));
    }
    if (object.place && object.rejected.empty() && hypothesis.estimate.size_ratio && !hypothesis.estimate.HasPath()) {
      heights.Add(hypothesis, object.place->point.altitude_m);
    }
    objects.push_back(std::move(object));
  }
  const std::map<std::int64_t, double> median_heights_m = heights.Medians();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    RejectFloating(hypotheses[i], median_heights_m, options, objects[i]);
    Score(hypotheses[i], searches.TestsOf(hypotheses[i]), options, objects[i]);
  }
  RejectOverlapping(objects, by_id, overlaps);
  RejectCoincident(objects, by_id);
  std::ranges::sort(objects, {}, &ObjectRecord::id);
  return objects;
}

std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, const SearchCounts& searches,
                                             const ObjectOptions& options) {
  std::ranges::sort(tracklets, {}, [](const ObservedTracklet& tracklet) { return tracklet.record.id; });
  std::vector<const ObservedTracklet*> pointers;
  std::map<std::int64_t, std::vector<const ObservedTracklet*>> of_video;
  for (ObservedTracklet& tracklet : tracklets) {
    tracklet.summary = Summarise(tracklet);
    pointers.push_back(&tracklet);
    of_video[tracklet.record.video].push_back(&tracklet);
  }
  std::vector<TrackletOverlap> overlaps;
  for (const auto& [video, of_one] : of_video) std::ranges::copy(FindOverlaps(of_one), std::back_inserter(overlaps));
  Fits fits(options);
  return AssociateTracklets(pointers, overlaps, searches, fits);
}

}  // namespace victorious
