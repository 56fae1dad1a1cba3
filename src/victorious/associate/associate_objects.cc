#include "victorious/associate/associate_objects.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/associate/flight_errors.h"
#include "victorious/associate/object_hypothesis.h"
#include "victorious/associate/object_rejection.h"
#include "victorious/observe/bearing_observation.h"

namespace victorious {
namespace {

// The height of an object's centre, as the other objects of its flight show the ground.
struct Level {
  double altitude_m = 0;
  double sigma_m = 0;
};

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
    const bool drives = !estimate.path.empty();
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
                               const ObjectOptions& options) {
  ObjectPlace estimate = AbsolutePlace(hypothesis, options);
  if (options.ground || estimate.path.empty() || hypothesis.estimate.path.size() != estimate.path.size()) {
    return estimate;
  }
  const std::optional<Level> level = LevelUnder(hypothesis, of_its_flight, options);
  if (!level) return estimate;
  ObjectOptions on_ground = options;
  on_ground.ground = std::make_shared<const FlatGround>(level->altitude_m - options.centre_height_m);
  on_ground.locate.ground_sigma_m = level->sigma_m;
  const ObjectPlace placed = EstimatePlace(hypothesis, on_ground, kFlightErrorFraction);
  if (placed.path.size() != estimate.path.size()) return estimate;
  for (std::size_t i = 0; i < placed.path.size(); ++i)
    estimate.path[i] = WithCommonErrors(placed.path[i], hypothesis.estimate.path[i], estimate.path[i]);
  estimate.place = estimate.path.back();
  return estimate;
}

// The hypotheses by their flight; those of several flights belong to none.
std::map<std::int64_t, std::vector<const ObjectHypothesis*>> ByFlight(const std::vector<ObjectHypothesis>& hypotheses) {
  std::map<std::int64_t, std::vector<const ObjectHypothesis*>> of_flight;
  for (const ObjectHypothesis& hypothesis : hypotheses) {
    if (IsInOneVideo(hypothesis)) of_flight[hypothesis.tracklets[0]->record.video].push_back(&hypothesis);
  }
  return of_flight;
}

}  // namespace

std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, std::int64_t frames_searched,
                                             const ObjectOptions& options) {
  std::ranges::sort(tracklets, {}, [](const ObservedTracklet& tracklet) { return tracklet.record.id; });
  std::map<std::int64_t, const ObservedTracklet*> by_id;
  std::map<std::int64_t, std::vector<const ObservedTracklet*>> of_model;
  for (const ObservedTracklet& tracklet : tracklets) {
    by_id[tracklet.record.id] = &tracklet;
    of_model[tracklet.record.model].push_back(&tracklet);
  }
  std::vector<ObjectHypothesis> hypotheses;
  for (const auto& [model, of_one] : of_model)
    std::ranges::move(MergeTracklets(of_one, options), std::back_inserter(hypotheses));

  std::vector<ObjectRecord> objects;
  HeightStatistics heights;
  std::vector<ObjectPlace> estimates;
  const auto of_flight = ByFlight(hypotheses);
  for (ObjectHypothesis& hypothesis : hypotheses) {
    const auto others = of_flight.find(hypothesis.tracklets[0]->record.video);
    estimates.push_back(EstimateFinalPlace(
        hypothesis, others != of_flight.end() ? std::span(others->second) : std::span<const ObjectHypothesis* const>(),
        options));
  }
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    ObjectHypothesis& hypothesis = hypotheses[i];
    hypothesis.estimate = std::move(estimates[i]);
    ObjectRecord object{.id = hypothesis.tracklets[0]->record.id,
                        .model = hypothesis.tracklets[0]->record.model,
                        .place = hypothesis.estimate.place,
                        .heading_rad = hypothesis.estimate.heading_rad};
    for (const ObservedTracklet* tracklet : hypothesis.tracklets) object.tracklets.push_back(tracklet->record.id);
    std::string reason = PlaceRejectionReason(hypothesis.estimate, CollectObservations(hypothesis).size(), options);
    if (!reason.empty()) RejectPlace(std::move(reason), object);
    if (!hypothesis.tracklets[0]->is_category &&
        IsInsignificant(hypothesis, object.place.has_value(), frames_searched, options)) {
      object.rejected =
          fmt::format("not significant: as strong a false detection is expected by chance in {} frames of one model",
                      frames_searched);
    }
    if (object.place && object.rejected.empty() && hypothesis.estimate.size_ratio && hypothesis.estimate.path.empty()) {
      heights.Add(hypothesis, object.place->point.altitude_m);
    }
    objects.push_back(std::move(object));
  }
  for (std::size_t i = 0; i < objects.size(); ++i) RejectFloating(hypotheses[i], heights, options, objects[i]);
  RejectOccluded(objects, by_id);
  RejectCoincident(objects, by_id);
  std::ranges::sort(objects, {}, &ObjectRecord::id);
  return objects;
}

namespace {

// Number of frames between two full-frame searches: the field "every" of the search's options. Error: kDataLoss if
// there is none.
Expected<std::int64_t> SearchInterval(const SearchRecord& search, const std::string& video, const std::string& model) {
  const auto options = nlohmann::json::parse(search.options_json, nullptr, /*allow_exceptions=*/false);
  const auto every = options.is_object() ? options.find("every") : options.end();
  if (every == options.end() || !every->is_number_integer() || every->get<std::int64_t>() < 1) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: the stored options of the search for {} have no whole number \"every\" of at least 1",
                            video, model));
  }
  return every->get<std::int64_t>();
}

// Number of full-frame searches, summed over videos and models; categories do not count.
Expected<std::int64_t> CountFullFrameSearches(const std::vector<ModelRecord>& models, IndexStore& store) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  std::int64_t frames = 0;
  for (const VideoRecord& video : videos) {
    for (const ModelRecord& model : models) {
      if (model.IsCategory()) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<SearchRecord> search, store.FindSearch(video.id, model.id));
      if (!search) continue;
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t step, SearchInterval(*search, video.name, model.name));
      frames += (search->next_frame + step - 1) / step;
    }
  }
  return frames;
}

Expected<std::vector<ObjectRecord>> MakeObjects(
    const ObjectOptions& options, IndexStore& store, FlightErrorCache& cache,
    const std::function<void(const VideoRecord&, const std::string&)>& warn) {
  std::map<std::int64_t, ObservedTracklet> tracklets;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<TrackletRecord> records, store.Tracklets());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  std::set<std::int64_t> categories;
  std::set<std::int64_t> cad_models;
  for (const ModelRecord& model : models) {
    if (model.IsCategory()) categories.insert(model.id);
    if (model.kind == ModelKind::kCad) cad_models.insert(model.id);
  }
  std::set<std::int64_t> photos;
  for (const VideoRecord& video : videos) {
    if (video.is_of_photos) photos.insert(video.id);
  }
  for (const TrackletRecord& record : records) {
    tracklets[record.id] = {.record = record,
                            .is_category = categories.contains(record.model),
                            .is_cad_model = cad_models.contains(record.model),
                            .is_of_photos = photos.contains(record.video)};
  }
  std::int64_t recognitions = 0;
  VICTORIOUS_RETURN_IF_ERROR(store.VisitSightings({.include_rejected = true}, [&](SightingRecord&& sighting) {
    const auto tracklet = tracklets.find(sighting.tracklet);
    if (tracklet == tracklets.end()) return true;  // added by another process in the meantime
    tracklet->second.frames.push_back(sighting.frame);
    tracklet->second.boxes.push_back(sighting.box);
    if (sighting.source == SightingSource::kRecognised) tracklet->second.scores.push_back(sighting.score);
    if (!sighting.observation) return true;
    std::vector<BearingObservation>& observations = tracklet->second.observations;
    sighting.observation->recognition_id =
        NextRecognitionId(sighting, observations.empty() ? nullptr : &observations.back(), recognitions);
    observations.push_back(*std::move(sighting.observation));
    return true;
  }));
  std::vector<ObservedTracklet> seen;
  for (auto& [id, tracklet] : tracklets) seen.push_back(std::move(tracklet));
  const std::map<std::int64_t, FlightErrors> errors = cache.Correct(seen, options);
  for (const VideoRecord& video : videos) {
    const auto found = errors.find(video.id);
    if (found == errors.end()) continue;
    for (const std::string& line : Describe(found->second)) warn(video, line);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t frames_searched, CountFullFrameSearches(models, store));
  return AssociateTracklets(std::move(seen), frames_searched, options);
}

}  // namespace

Status UpdateObjects(const ObjectOptions& options, IndexStore& store, FlightErrorCache& cache,
                     const CancelToken& cancel,
                     const std::function<void(const VideoRecord&, const std::string&)>& warn) {
  std::vector<std::pair<VideoRecord, std::string>> warnings;
  const auto make = [&] {
    warnings.clear();
    return MakeObjects(options, store, cache, [&](const VideoRecord& video, const std::string& warning) {
      warnings.emplace_back(video, warning);
    });
  };
  VICTORIOUS_RETURN_IF_ERROR(store.UpdateObjects(make, cancel));
  for (const auto& [video, warning] : warnings) warn(video, warning);
  return {};
}

}  // namespace victorious
