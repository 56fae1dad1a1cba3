#include "victorious/associate/associate_objects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "victorious/associate/fits.h"
#include "victorious/associate/flight_fusion.h"
#include "victorious/associate/flight_registration.h"
#include "victorious/associate/merge_flights.h"
#include "victorious/associate/neighbours.h"
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

// The hypotheses of each flight, by video.
using Flights = std::map<std::int64_t, std::vector<const ObjectHypothesis*>>;

// The final estimate of one flight.
struct FlightPlace {
  ObjectPlace absolute;
  ObjectPlace relative;  // of the same time
};

// An object that drives is placed on the ground that the other objects of its flight show, unless the ground is given:
// its height then fixes the distance better than its size.
FlightPlace EstimateInFlight(ObjectHypothesis& part, std::span<const ObjectHypothesis* const> of_its_flight,
                             Fits& fits) {
  FlightPlace result{.absolute = AbsolutePlace(part, fits), .relative = part.estimate};
  ObjectPlace& absolute = result.absolute;
  if (fits.options().ground || !absolute.HasPath() || part.estimate.path_size != absolute.path_size) return result;
  const std::optional<Level> level = LevelUnder(part, of_its_flight, fits.options());
  if (!level) return result;
  const LevelPlace placed = fits.OnLevel(part, *level);
  if (!placed.absolute) return result;
  absolute.place = placed.absolute;
  result.relative.place = placed.relative.place;
  result.relative.path = {*placed.relative.place};
  return result;
}

// One object, as each of its flights sees it: at least one, by video.
using ObjectParts = std::vector<ObjectHypothesis*>;

ObjectHypothesis JoinParts(const ObjectParts& parts, const Flights& flights, Fits& fits) {
  ObjectHypothesis joined;
  std::vector<ObjectInFlight> of_flights;
  for (ObjectHypothesis* part : parts) {
    std::ranges::copy(part->tracklets, std::back_inserter(joined.tracklets));
    FlightPlace place = EstimateInFlight(*part, flights.at(VideoOf(*part)), fits);
    if (parts.size() == 1) {
      joined.estimate = std::move(place.absolute);
      return joined;
    }
    of_flights.push_back(*MakeObjectInFlight(*part, fits));
    of_flights.back().SetPlaces(std::move(place.relative), *place.absolute.place);
  }
  std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  ObjectInFlights pointers;
  for (const ObjectInFlight& flight : of_flights) pointers.push_back(&flight);
  joined.estimate = FuseFlights(pointers);
  return joined;
}

// The objects with a place, as their flights see them, and their hypotheses.
struct PlacedObjects {
  std::vector<ObjectInFlight> objects;
  std::vector<ObjectHypothesis*> hypotheses;  // of each of `objects`
  std::vector<ObjectHypothesis*> without_place;
};

// Those that move have paths where another flight sees one of their model at the time.
PlacedObjects CollectObjectsInFlight(std::vector<ObjectHypothesis>& hypotheses, Fits& fits) {
  PlacedObjects placed;
  std::vector<ObjectInFlight>& objects = placed.objects;
  objects.reserve(hypotheses.size());
  for (ObjectHypothesis& hypothesis : hypotheses) {
    std::optional<ObjectInFlight> object = MakeObjectInFlight(hypothesis, fits);
    (object ? placed.hypotheses : placed.without_place).push_back(&hypothesis);
    if (object) objects.push_back(*std::move(object));
  }
  std::map<std::int64_t, Neighbours> of_models;
  std::map<std::int64_t, std::int64_t> videos;  // by id
  const auto whereabouts = [](const ObjectInFlight& object) {
    const ObjectInFlight* const alone = &object;
    return FindWhereabouts({&alone, 1});
  };
  for (const ObjectInFlight& object : objects) {
    of_models.try_emplace(object.model, 0).first->second.Add(whereabouts(object), object.id);
    videos[object.id] = object.video;
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ObjectInFlight& object = objects[i];
    if (!object.relative.HasPath()) continue;
    const std::set<std::int64_t> near = of_models.at(object.model).Near(whereabouts(object));
    if (std::ranges::any_of(near, [&](std::int64_t id) { return videos.at(id) != object.video; }))
      object.relative = WithPath(*placed.hypotheses[i], fits);
  }
  return placed;
}

// The parts of each object, by model and id.
// @param hypotheses  by model and id
std::vector<ObjectParts> MergeAcrossFlights(std::vector<ObjectHypothesis>& hypotheses, Fits& fits) {
  const PlacedObjects placed = CollectObjectsInFlight(hypotheses, fits);
  const FlightRegistrations registrations = RegisterFlights(placed.objects, fits.options().merge_gate_sigma);
  std::map<std::int64_t, ObjectInFlights> of_models;
  for (const ObjectInFlight& object : placed.objects) of_models[object.model].push_back(&object);
  std::vector<ObjectParts> result;
  result.reserve(hypotheses.size());
  for (const auto& [model, of_model] : of_models) {
    for (const ObjectInFlights& merged : MergeFlights(of_model, registrations, fits.options())) {
      ObjectParts& parts = result.emplace_back();
      for (const ObjectInFlight* part : merged)
        parts.push_back(placed.hypotheses[static_cast<std::size_t>(part - placed.objects.data())]);
    }
  }
  for (ObjectHypothesis* hypothesis : placed.without_place) result.push_back({hypothesis});
  std::ranges::sort(result, {}, [](const ObjectParts& parts) { return parts.front(); });
  return result;
}

std::size_t CountObservations(const ObjectHypothesis& hypothesis) {
  std::int64_t observations = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) observations += tracklet->summary.observations;
  return static_cast<std::size_t>(observations);
}

void Score(const ObjectHypothesis& hypothesis, double tests, const ObjectOptions& options, ObjectRecord& object) {
  if (hypothesis.tracklets[0]->is_category) return;  // its score is the classifier's
  const ObjectEvidence evidence = CollectEvidence(hypothesis, object, tests, options);
  object.object_score = ScoreObject(evidence);
  object.against = SpeaksAgainst(evidence);
  object.evidence_json = ToJsonText(evidence);
}

// By its own evidence.
ObjectRecord MakeObject(const ObjectHypothesis& hypothesis, double tests, const ObjectOptions& options) {
  ObjectRecord object{.id = hypothesis.tracklets[0]->record.id,
                      .model = hypothesis.tracklets[0]->record.model,
                      .place = hypothesis.estimate.place,
                      .heading_rad = hypothesis.estimate.heading_rad};
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) object.tracklets.push_back(tracklet->record.id);
  std::string reason = PlaceRejectionReason(hypothesis.estimate, CountObservations(hypothesis), options);
  if (!reason.empty()) RejectPlace(std::move(reason), object);
  if (!hypothesis.tracklets[0]->is_category && IsInsignificant(hypothesis, object.place.has_value(), tests, options)) {
    object.rejected = fmt::format(
        "not significant: as strong a false detection is expected by chance in {:.0f} frames of one model", tests);
  }
  return object;
}

// Rejects and scores each of them, but for what other objects say beyond the heights of their videos.
std::vector<ObjectRecord> JudgeEach(std::span<const ObjectHypothesis> hypotheses, const SearchCounts& searches,
                                    const ObjectOptions& options) {
  std::vector<ObjectRecord> objects(hypotheses.size());
  std::vector<double> tests(hypotheses.size());
  oneapi::tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    tests[i] = searches.TestsOf(hypotheses[i]);
    objects[i] = MakeObject(hypotheses[i], tests[i], options);
  });
  HeightStatistics heights;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectPlace& estimate = hypotheses[i].estimate;
    if (objects[i].place && objects[i].rejected.empty() && estimate.size_ratio && !estimate.HasPath())
      heights.Add(hypotheses[i], objects[i].place->point.altitude_m);
  }
  const std::map<std::int64_t, double> median_heights_m = heights.Medians();
  oneapi::tbb::parallel_for(std::size_t{0}, objects.size(), [&](std::size_t i) {
    RejectFloating(hypotheses[i], median_heights_m, options, objects[i]);
    Score(hypotheses[i], tests[i], options, objects[i]);
  });
  return objects;
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
  std::vector<ObjectHypothesis> of_flights;
  for (const auto& [model, of_one] : of_model)
    std::ranges::move(MergeTracklets(of_one, fits), std::back_inserter(of_flights));
  Flights flights;
  for (const ObjectHypothesis& hypothesis : of_flights) flights[VideoOf(hypothesis)].push_back(&hypothesis);

  const std::vector<ObjectParts> all_parts = MergeAcrossFlights(of_flights, fits);
  std::vector<ObjectHypothesis> joined;
  joined.reserve(all_parts.size());
  for (const ObjectParts& parts : all_parts) joined.push_back(JoinParts(parts, flights, fits));
  std::vector<ObjectRecord> objects = JudgeEach(joined, searches, options);
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
