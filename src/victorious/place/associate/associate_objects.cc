#include "victorious/place/associate/associate_objects.h"

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

#include "victorious/base/count_text.h"
#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/flight_evidence.h"
#include "victorious/place/associate/flight_fusion.h"
#include "victorious/place/associate/flight_registration.h"
#include "victorious/place/associate/length_error.h"
#include "victorious/place/associate/link_constraints.h"
#include "victorious/place/associate/linked_objects.h"
#include "victorious/place/associate/merge_flights.h"
#include "victorious/place/associate/neighbours.h"
#include "victorious/place/associate/object_hypothesis.h"
#include "victorious/place/associate/object_rejection.h"
#include "victorious/place/associate/object_score.h"

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
std::vector<ObjectParts> MergeAcrossFlights(std::vector<ObjectHypothesis>& hypotheses,
                                            const LinkConstraints& constraints, Fits& fits) {
  const PlacedObjects placed = CollectObjectsInFlight(hypotheses, fits);
  const FlightRegistrations registrations = RegisterFlights(placed.objects, fits.options().merge_gate_sigma);
  std::map<std::int64_t, ObjectInFlights> of_models;
  for (const ObjectInFlight& object : placed.objects) of_models[object.model].push_back(&object);
  std::vector<ObjectParts> result;
  result.reserve(hypotheses.size());
  for (const auto& [model, of_model] : of_models) {
    for (const ObjectInFlights& merged : MergeFlights(of_model, registrations, constraints, fits.options())) {
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

// An object with what its place says, while the flights are judged.
struct Judged {
  ObjectRecord object;
  double tests = 0;
  PlaceFinding finding = PlaceFinding::kNothing;
  double apart_m = 0;                   // between places that people say to be of one object
  double weight = 0;                    // of `finding`, by all objects of its flights
  std::int64_t confirming_objects = 0;  // of other models, in the same flights

  void Contradict(PlaceContradiction contradiction) {
    finding = contradiction.finding;
    RejectPlace(std::move(contradiction.reason), object);
  }
};

void Score(const ObjectHypothesis& hypothesis, const ObjectOptions& options, Judged& judged) {
  if (hypothesis.tracklets[0]->is_category) return;  // its score is the classifier's
  ObjectRecord& object = judged.object;
  ObjectEvidence evidence = CollectEvidence(hypothesis, object, judged.tests, options);
  if (!object.place_rejected.empty() || evidence.length_factor != 1) evidence.place_weight = judged.weight;
  object.object_score = ScoreObject(evidence);
  object.against = SpeaksAgainst(evidence);
  object.evidence_json = ToJsonText(evidence);
}

// True if nothing but its telemetry, the model's length and the object itself decides that its size fits its place.
bool IsAgreement(const ObjectHypothesis& hypothesis, const ObjectOptions& options) {
  constexpr double kAgreeingSize = 0.1;  // |log ratio|: twice what counts against a score
  const ObjectPlace& estimate = hypothesis.estimate;
  return estimate.place && estimate.size_ratio && !estimate.HasPath() &&
         std::abs(std::log(*estimate.size_ratio)) <= kAgreeingSize &&
         estimate.inlier_fraction >= options.min_inlier_fraction;
}

// By which the model's length was found wrong in one of its flights; 1: it is right.
double LengthFactor(const ObjectHypothesis& hypothesis) {
  const auto wrong =
      std::ranges::find_if(hypothesis.tracklets, [](const auto* tracklet) { return tracklet->length_factor != 1; });
  return wrong == hypothesis.tracklets.end() ? 1 : (*wrong)->length_factor;
}

// By its own evidence.
Judged MakeObject(const ObjectHypothesis& hypothesis, double tests, const ObjectOptions& options) {
  Judged judged{.object = {.id = hypothesis.tracklets[0]->record.id,
                           .model = hypothesis.tracklets[0]->record.model,
                           .place = hypothesis.estimate.place,
                           .heading_rad = hypothesis.estimate.heading_rad},
                .tests = tests};
  ObjectRecord& object = judged.object;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) object.tracklets.push_back(tracklet->record.id);
  std::optional<PlaceContradiction> contradiction =
      FindContradiction(hypothesis.estimate, CountObservations(hypothesis), options);
  if (contradiction) {
    judged.Contradict(*std::move(contradiction));
  } else if (LengthFactor(hypothesis) != 1) {
    judged.finding = PlaceFinding::kImpossible;
  } else if (IsAgreement(hypothesis, options)) {
    judged.finding = PlaceFinding::kAgrees;
  }
  if (!hypothesis.tracklets[0]->is_category && IsInsignificant(hypothesis, object.place.has_value(), tests, options)) {
    object.rejected = fmt::format(
        "not significant: as strong a false detection is expected by chance in {:.0f} frames of one model", tests);
  }
  return judged;
}

// Weighs the findings of each flight. Of an object that several flights see, the mildest counts: the telemetry of one
// being wrong is enough.
void WeighPlaces(std::span<const ObjectHypothesis> hypotheses, const ObjectOptions& options,
                 std::vector<Judged>& judged) {
  std::map<std::int64_t, std::vector<std::size_t>> flights;  // indices, by video
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (judged[i].finding == PlaceFinding::kNothing || hypotheses[i].tracklets[0]->is_category) continue;
    for (const std::int64_t video : VideosOf(hypotheses[i])) flights[video].push_back(i);
  }
  std::vector<bool> is_weighed(judged.size());
  for (const auto& [video, of_flight] : flights) {
    std::vector<FindingOfObject> findings;
    std::int64_t agreeing = 0;
    std::map<std::int64_t, std::int64_t> agreeing_of_model;
    for (const std::size_t i : of_flight) {
      // Without its place: what that says is weighed here. What is as strong as chance makes says nothing of the
      // flight.
      const bool is_significant = judged[i].object.rejected.empty();
      const ObjectEvidence recognition = CollectEvidence(hypotheses[i], {}, judged[i].tests, options);
      findings.push_back({judged[i].object.model, is_significant ? ScoreObject(recognition) : 0, judged[i].finding});
      if (!is_significant) continue;
      if (judged[i].finding != PlaceFinding::kAgrees) continue;
      ++agreeing;
      ++agreeing_of_model[judged[i].object.model];
    }
    const std::vector<double> weights = WeighFindings(findings);
    for (std::size_t k = 0; k < of_flight.size(); ++k) {
      Judged& one = judged[of_flight[k]];
      if (is_weighed[of_flight[k]] && weights[k] <= one.weight) continue;
      is_weighed[of_flight[k]] = true;
      one.weight = weights[k];
      one.confirming_objects = agreeing - agreeing_of_model[one.object.model];
    }
  }
}

// Rejects a find that its contradicted place, or length, leaves too weak.
void RejectWeak(const ObjectHypothesis& hypothesis, const ObjectOptions& options, Judged& judged) {
  ObjectRecord& object = judged.object;
  const double factor = LengthFactor(hypothesis);
  const bool is_contradicted = !object.place_rejected.empty() || factor != 1;
  if (!is_contradicted || !object.rejected.empty() || hypothesis.tracklets[0]->is_category) return;
  if (!IsInsignificant(hypothesis, false, judged.tests, options, judged.weight)) return;
  object.rejected =
      fmt::format("weak, and {}", object.place_rejected.empty() ? DescribeLengthFactor(factor) : object.place_rejected);
  if (judged.confirming_objects > 0)
    object.rejected +=
        fmt::format(", with telemetry that {} of other models {}", CountText(judged.confirming_objects, "object"),
                    judged.confirming_objects == 1 ? "confirms" : "confirm");
}

// Makes the second part of the first, which then has the place of one of them. The second is empty.
void Join(ObjectHypothesis& into, Judged& judged, ObjectHypothesis& from, Judged& other, const SearchCounts& searches,
          const ObjectOptions& options) {
  const std::int64_t id = judged.object.id;
  const double apart_m =
      std::max({judged.apart_m, other.apart_m, DistanceApart_m(judged.object, other.object, options)});
  if (IsPreferred(other.object, from, judged.object, into, options)) {
    std::swap(into.estimate, from.estimate);
    std::swap(judged, other);
  }
  std::ranges::copy(from.tracklets, std::back_inserter(into.tracklets));
  std::ranges::sort(into.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  from.tracklets.clear();
  ObjectRecord& object = judged.object;
  object.id = std::min(id, into.tracklets.front()->record.id);
  object.tracklets.clear();
  for (const ObservedTracklet* tracklet : into.tracklets) object.tracklets.push_back(tracklet->record.id);
  judged.tests = searches.TestsOf(into);
  if (!object.rejected.empty()) {
    const bool is_contradicted = !object.place_rejected.empty() || LengthFactor(into) != 1;
    const double weight = is_contradicted ? judged.weight : 0;
    if (!IsInsignificant(into, object.place.has_value(), judged.tests, options, weight)) object.rejected.clear();
  }
  judged.apart_m = apart_m;
  Score(into, options, judged);
  if (apart_m > 0) object.against.push_back(fmt::format("joined by a person: seen {:.0f} m apart", apart_m));
}

// Rejects and scores each of them, but for what other objects say beyond the heights of their videos and what their
// places say of telemetry.
std::vector<ObjectRecord> JudgeEach(std::vector<ObjectHypothesis> hypotheses, const SearchCounts& searches,
                                    const LinkConstraints& constraints, Fits& fits) {
  const ObjectOptions& options = fits.options();
  std::vector<Judged> judged(hypotheses.size());
  oneapi::tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    judged[i] = MakeObject(hypotheses[i], searches.TestsOf(hypotheses[i]), options);
  });
  HeightStatistics heights;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    const ObjectPlace& estimate = hypotheses[i].estimate;
    const ObjectRecord& object = judged[i].object;
    if (object.place && object.rejected.empty() && estimate.size_ratio && !estimate.HasPath())
      heights.Add(hypotheses[i], object.place->point.altitude_m);
  }
  const std::map<std::int64_t, double> median_heights_m = heights.Medians();
  oneapi::tbb::parallel_for(std::size_t{0}, judged.size(), [&](std::size_t i) {
    auto contradiction = FindFloating(hypotheses[i], median_heights_m, options, judged[i].object);
    if (contradiction) judged[i].Contradict(*std::move(contradiction));
  });
  WeighPlaces(hypotheses, options, judged);
  oneapi::tbb::parallel_for(std::size_t{0}, judged.size(), [&](std::size_t i) {
    RejectWeak(hypotheses[i], options, judged[i]);
    Score(hypotheses[i], options, judged[i]);
  });
  JoinLinked(constraints, hypotheses, fits, [&](std::size_t into, std::size_t from) {
    Join(hypotheses[into], judged[into], hypotheses[from], judged[from], searches, options);
  });
  std::vector<ObjectRecord> objects;
  objects.reserve(judged.size());
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (!hypotheses[i].tracklets.empty()) objects.push_back(std::move(judged[i].object));
  }
  return objects;
}

}  // namespace

std::vector<ObjectRecord> AssociateTracklets(std::span<const ObservedTracklet* const> tracklets,
                                             std::span<const TrackletOverlap> overlaps, const SearchCounts& searches,
                                             const LinkConstraints& links, Fits& fits) {
  std::map<std::int64_t, const ObservedTracklet*> by_id;
  std::map<std::int64_t, std::vector<const ObservedTracklet*>> of_model;
  for (const ObservedTracklet* tracklet : tracklets) {
    by_id.emplace_hint(by_id.end(), tracklet->record.id, tracklet);
    of_model[tracklet->record.model].push_back(tracklet);
  }
  LinkConstraints constraints = links;
  for (const auto& [model, of_one] : of_model) SeparateFromGroups(of_one, fits, constraints);
  std::vector<ObjectHypothesis> of_flights;
  for (const auto& [model, of_one] : of_model)
    std::ranges::move(MergeTracklets(of_one, constraints, fits), std::back_inserter(of_flights));
  Flights flights;
  for (const ObjectHypothesis& hypothesis : of_flights) flights[VideoOf(hypothesis)].push_back(&hypothesis);

  const std::vector<ObjectParts> all_parts = MergeAcrossFlights(of_flights, constraints, fits);
  std::vector<ObjectHypothesis> joined;
  joined.reserve(all_parts.size());
  for (const ObjectParts& parts : all_parts) joined.push_back(JoinParts(parts, flights, fits));
  std::vector<ObjectRecord> objects = JudgeEach(std::move(joined), searches, constraints, fits);
  RejectOverlapping(objects, by_id, overlaps, constraints);
  RejectCoincident(objects, by_id, constraints);
  std::ranges::sort(objects, {}, &ObjectRecord::id);
  return objects;
}

std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, const SearchCounts& searches,
                                             const ObjectOptions& options, const LinkConstraints& constraints) {
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
  return AssociateTracklets(pointers, overlaps, searches, constraints, fits);
}

}  // namespace victorious
