#include "victorious/associate/associate_objects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
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
#include "victorious/associate/object_place.h"
#include "victorious/base/median.h"
#include "victorious/observe/bearing_observation.h"

namespace victorious {
namespace {

// Tracklets merged into one object hypothesis.
struct ObjectHypothesis {
  std::vector<const ObservedTracklet*> tracklets;  // by id
  ObjectPlace estimate;                            // place for the comparison with others of its flight
};

std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis) {
  std::vector<BearingObservation> observations;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    for (BearingObservation observation : tracklet->observations) {
      if (observation.line.clock_shift) observation.line.clock_shift->flight = tracklet->record.video;
      observations.push_back(std::move(observation));
    }
  }
  std::ranges::stable_sort(observations, {},
                           [](const BearingObservation& observation) { return observation.line.time_s; });
  return observations;
}

bool IsInOneVideo(const ObjectHypothesis& hypothesis) {
  return std::ranges::all_of(hypothesis.tracklets, [&](const ObservedTracklet* tracklet) {
    return tracklet->record.video == hypothesis.tracklets[0]->record.video;
  });
}

bool IsInPhotos(const ObjectHypothesis& hypothesis) {
  return std::ranges::any_of(hypothesis.tracklets, &ObservedTracklet::is_of_photos);
}

// Videos have no common clock, and photos none at all, so an object of several videos or of photos is modelled as static.
ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options, double common_fraction) {
  if (!IsInOneVideo(hypothesis) || IsInPhotos(hypothesis)) options.locate.motion = MotionModel::kStatic;
  return EstimatePlace(CollectObservations(hypothesis), options, common_fraction);
}

bool HasCommonFrame(const ObservedTracklet& a, const ObservedTracklet& b) {
  if (a.record.video != b.record.video) return false;
  std::vector<std::int64_t> both;
  std::ranges::set_intersection(a.frames, b.frames, std::back_inserter(both));
  return !both.empty();
}

bool HasCommonFrame(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets, [&](const ObservedTracklet* of_b) { return HasCommonFrame(*of_a, *of_b); });
  });
}

bool HasCommonVideo(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets,
                               [&](const ObservedTracklet* of_b) { return of_a->record.video == of_b->record.video; });
  });
}

double FirstTime(const ObjectHypothesis& hypothesis) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const ObservedTracklet* tracklet : hypothesis.tracklets)
    first_s = std::min(first_s, tracklet->record.first_time_s);
  return first_s;
}

double LastTime(const ObjectHypothesis& hypothesis) {
  double last_s = -std::numeric_limits<double>::infinity();
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) last_s = std::max(last_s, tracklet->record.last_time_s);
  return last_s;
}

// Distance of two hypotheses at the time midway between them: Euclidean and Mahalanobis.
struct Distance {
  double metres = 0;
  double sigmas = 0;
};

std::optional<Distance> ComputeDistance(const ObjectHypothesis& a, const ObjectHypothesis& b,
                                        const ObjectOptions& options) {
  std::optional<Geolocation> of_a = a.estimate.place;
  std::optional<Geolocation> of_b = b.estimate.place;
  const bool of_one_flight = HasCommonVideo(a, b) && IsInOneVideo(a) && IsInOneVideo(b);
  if (!of_one_flight) {  // flights have independent common errors
    of_a = EstimatePlace(a, options, 1).place;
    of_b = EstimatePlace(b, options, 1).place;
    if (!of_a || !of_b || of_a->IsMoving() || of_b->IsMoving()) return std::nullopt;
  }
  if (!of_a || !of_b) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a->point);
  const Geolocation at_a = of_one_flight ? PlaceAt(a.estimate, between_s) : PropagatePlace(*of_a, between_s);
  const Geolocation at_b = of_one_flight ? PlaceAt(b.estimate, between_s) : PropagatePlace(*of_b, between_s);
  const double slack_m2 = 2 * kMergeSlack_m * kMergeSlack_m;
  const Eigen::Matrix3d covariance =
      at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + slack_m2 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return Distance{apart.norm(), std::sqrt(apart.dot(covariance.ldlt().solve(apart)))};
}

ObjectHypothesis MergedPair(const ObjectHypothesis& a, const ObjectHypothesis& b, const ObjectOptions& options) {
  ObjectHypothesis joined{.tracklets = a.tracklets};
  joined.tracklets.insert(joined.tracklets.end(), b.tracklets.begin(), b.tracklets.end());
  std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  joined.estimate = EstimatePlace(joined, options, IsInOneVideo(joined) ? kFlightErrorFraction : 1);
  return joined;
}

// Agglomerative merging of the hypotheses of one model, nearest pair (Mahalanobis) first, until no pair passes the
// gates.
void MergeHypotheses(std::vector<ObjectHypothesis>& hypotheses, const ObjectOptions& options) {
  using Pair = std::pair<std::int64_t, std::int64_t>;  // first tracklet ids of two hypotheses
  std::map<Pair, double> distances;
  const auto id_of = [](const ObjectHypothesis& hypothesis) { return hypothesis.tracklets[0]->record.id; };
  const auto measure = [&](const ObjectHypothesis& a, const ObjectHypothesis& b) {
    if (HasCommonFrame(a, b)) return;
    const std::optional<Distance> distance = ComputeDistance(a, b, options);
    if (!distance || distance->metres > options.max_merge_distance_m) return;
    if (distance->sigmas <= options.merge_gate_sigma) distances[std::minmax(id_of(a), id_of(b))] = distance->sigmas;
  };
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    for (std::size_t k = i + 1; k < hypotheses.size(); ++k) measure(hypotheses[i], hypotheses[k]);
  }
  while (!distances.empty()) {
    const Pair nearest = std::ranges::min_element(distances, {}, [](const auto& entry) {
                           return std::pair(entry.second, entry.first);
                         })->first;
    const auto a = std::ranges::find(hypotheses, nearest.first, id_of);
    const auto b = std::ranges::find(hypotheses, nearest.second, id_of);
    ObjectHypothesis joined = MergedPair(*a, *b, options);
    if (!joined.estimate.place || joined.estimate.inlier_fraction < options.min_inlier_fraction) {
      distances.erase(nearest);
      continue;
    }
    std::erase_if(distances, [&](const auto& entry) {
      const auto& [first, second] = entry.first;
      return first == nearest.first || first == nearest.second || second == nearest.first || second == nearest.second;
    });
    *a = std::move(joined);
    const std::int64_t id = id_of(*a);
    hypotheses.erase(b);
    const ObjectHypothesis& grown = *std::ranges::find(hypotheses, id, id_of);
    for (const ObjectHypothesis& other : hypotheses) {
      if (&other != &grown) measure(grown, other);
    }
  }
}

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

// Median height, per video, of the objects whose place follows from intersection and not from apparent size only.
class HeightStatistics {
 public:
  void Add(const ObjectHypothesis& hypothesis, double altitude_m) {
    for (const ObservedTracklet* tracklet : hypothesis.tracklets)
      of_video_[tracklet->record.video].push_back(altitude_m);
  }
  [[nodiscard]] std::optional<double> MedianHeight(const ObjectHypothesis& hypothesis) const {
    const auto found = of_video_.find(hypothesis.tracklets[0]->record.video);
    if (found == of_video_.end()) return std::nullopt;
    return Median(found->second);
  }

 private:
  std::map<std::int64_t, std::vector<double>> of_video_;
};

bool IsSizeContradicted(const ObjectPlace& estimate, const ObjectOptions& options) {
  const double ratio = estimate.size_ratio.value_or(1);
  return ratio > options.max_size_ratio || ratio < 1 / options.max_size_ratio;
}

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
std::optional<Level> LevelUnder(const ObjectHypothesis& driving, std::span<const ObjectHypothesis> all,
                                const ObjectOptions& options) {
  struct Sample {
    double altitude_m;
    double weight;
  };
  std::vector<Sample> samples;
  double total = 0;
  const TangentPlane plane(driving.estimate.place->point);
  for (const ObjectHypothesis& other : all) {
    if (&other == &driving || !other.estimate.place || other.tracklets[0]->is_category) continue;
    if (!HasCommonVideo(driving, other) || !IsInOneVideo(other)) continue;
    if (other.estimate.inlier_fraction < options.min_inlier_fraction) continue;
    const bool drives = !other.estimate.path.empty();
    if (!drives && (!other.estimate.size_ratio || IsSizeContradicted(other.estimate, options))) continue;
    const Geolocation& place = *other.estimate.place;
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
ObjectPlace EstimateFinalPlace(const ObjectHypothesis& hypothesis, std::span<const ObjectHypothesis> all,
                               const ObjectOptions& options) {
  ObjectPlace estimate = EstimatePlace(hypothesis, options, 1);
  if (options.ground || estimate.path.empty() || hypothesis.estimate.path.size() != estimate.path.size()) {
    return estimate;
  }
  const std::optional<Level> level = LevelUnder(hypothesis, all, options);
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
// biased.
//
// kMaxFalseAlarms: maximum expected number of false detections as strong, over the whole search. Chosen: one search in
// ten has one.
constexpr double kMaxFalseAlarms = 0.1;

// @param placed  false: the object has no place, and the test rests on recognition alone
bool IsInsignificant(const ObjectHypothesis& hypothesis, bool placed, std::int64_t frames_searched,
                     const ObjectOptions& options) {
  double log_odds = 0;
  double recognised = 0;
  double frames = 0;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    frames += static_cast<double>(tracklet->record.frames);
    for (const double score : tracklet->scores) {
      log_odds += LogOdds(score);
      ++recognised;
    }
  }
  if (recognised > 0) log_odds /= recognised;
  if (placed) frames = std::max(1.0, frames * hypothesis.estimate.consistent_fraction);
  const double false_alarms_at_even_odds = options.false_alarm_rate * static_cast<double>(frames_searched);
  return std::exp(log_odds) * frames * kMaxFalseAlarms < false_alarms_at_even_odds;
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

// The reason why an estimated place is wrong; empty if nothing contradicts it. Wrong telemetry is as good an
// explanation as a false detection: the place is rejected, and the object stands or falls by its significance without
// one.
std::string PlaceRejectionReason(const ObjectPlace& estimate, std::size_t observations, const ObjectOptions& options) {
  if (estimate.place && IsBelowLowestGround(*estimate.place)) {
    return fmt::format("{:.0f} m below the sea, below any ground", -estimate.place->point.altitude_m);
  }
  // An object that drives is placed by its size: the distance of its lines, as if it stood still, contradicts nothing.
  if (estimate.path.empty() && IsSizeContradicted(estimate, options)) return SizeReason(*estimate.size_ratio);
  if (observations >= kMinObservations && estimate.inlier_fraction < options.min_inlier_fraction)
    return "its lines of sight do not intersect";
  return {};
}

// The heading rests on the same telemetry as the place.
void RejectPlace(std::string reason, ObjectRecord& object) {
  object.place_rejected = std::move(reason);
  object.place.reset();
  object.heading_rad.reset();
}

// Rejects the place of an object whose height follows from its size only and is far from the median height. If a place
// of another size fits its lines, the object does not drive at that height, but stands and is of that size.
void RejectFloating(const ObjectHypothesis& hypothesis, const HeightStatistics& heights, const ObjectOptions& options,
                    ObjectRecord& object) {
  const ObjectPlace& estimate = hypothesis.estimate;
  const bool other_size = !estimate.path.empty() && IsSizeContradicted(estimate, options);
  if ((estimate.size_ratio && !other_size) || !object.place || !object.rejected.empty() ||
      hypothesis.tracklets[0]->is_category)
    return;
  const std::optional<double> median_m = heights.MedianHeight(hypothesis);
  if (!median_m) return;
  const double above_m = object.place->point.altitude_m - *median_m;
  if (std::abs(above_m) < options.max_height_deviation_m) return;
  RejectPlace(other_size ? SizeReason(*estimate.size_ratio)
                         : fmt::format("{:.0f} m {} the other objects, judged by its size only", std::abs(above_m),
                                       above_m > 0 ? "above" : "below"),
              object);
}

// Rejects the less-observed of two CAD objects in the same pixels: one would occlude the other.
void RejectOccluded(std::vector<ObjectRecord>& objects,
                    const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  for (ObjectRecord& less : objects) {
    if (!less.rejected.empty() || !tracklets.at(less.id)->is_cad_model) continue;
    for (const ObjectRecord& more : objects) {
      if (!more.rejected.empty() || more.model == less.model || !tracklets.at(more.id)->is_cad_model) continue;
      if (!HasMoreFrames(more, less, tracklets)) continue;
      std::int64_t covered = 0;
      for (const std::int64_t tracklet : less.tracklets) {
        for (const std::int64_t by : more.tracklets)
          covered += CountOverlappingFrames(*tracklets.at(tracklet), *tracklets.at(by), kOcclusionIou);
      }
      if (2 * covered < CountObjectFrames(less, tracklets)) continue;
      less.rejected = fmt::format("in the same pixels as object {}", more.id);
      break;
    }
  }
}

// Rejects the less-observed of two coincident static objects.
void RejectCoincident(std::vector<ObjectRecord>& objects,
                      const std::map<std::int64_t, const ObservedTracklet*>& tracklets) {
  for (ObjectRecord& less : objects) {
    if (!less.place || !less.rejected.empty() || tracklets.at(less.id)->is_category) continue;
    const TangentPlane plane(less.place->point);
    for (const ObjectRecord& more : objects) {
      if (!more.place || !more.rejected.empty() || more.id == less.id || tracklets.at(more.id)->is_category) continue;
      if (!HasMoreFrames(more, less, tracklets)) continue;
      if (less.place->IsMoving() || more.place->IsMoving()) continue;
      if (plane.EnuFromGeodetic(more.place->point).norm() >= kMinSeparation_m) continue;
      less.rejected = fmt::format("at the same place as object {}", more.id);
      break;
    }
  }
}

}  // namespace

std::vector<ObjectRecord> AssociateTracklets(std::vector<ObservedTracklet> tracklets, std::int64_t frames_searched,
                                             const ObjectOptions& options) {
  std::ranges::sort(tracklets, {}, [](const ObservedTracklet& tracklet) { return tracklet.record.id; });
  std::map<std::int64_t, const ObservedTracklet*> by_id;
  std::map<std::int64_t, std::vector<ObjectHypothesis>> of_model;
  for (const ObservedTracklet& tracklet : tracklets) {
    by_id[tracklet.record.id] = &tracklet;
    ObjectHypothesis alone{.tracklets = {&tracklet}};
    alone.estimate = EstimatePlace(alone, options, kFlightErrorFraction);
    of_model[tracklet.record.model].push_back(std::move(alone));
  }
  std::vector<ObjectHypothesis> hypotheses;
  for (auto& [model, of_one] : of_model) {
    MergeHypotheses(of_one, options);
    std::ranges::move(of_one, std::back_inserter(hypotheses));
  }

  std::vector<ObjectRecord> objects;
  HeightStatistics heights;
  std::vector<ObjectPlace> estimates;
  for (const ObjectHypothesis& hypothesis : hypotheses)
    estimates.push_back(EstimateFinalPlace(hypothesis, hypotheses, options));
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
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<TrackletRecord> records, store.Tracklets());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelRecord> models, store.Models());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<VideoRecord> videos, store.Videos());
  for (TrackletRecord& record : records) {
    const auto video = std::ranges::find(videos, record.video, &VideoRecord::id);
    const auto model = std::ranges::find(models, record.model, &ModelRecord::id);
    const bool known = model != models.end();
    tracklets[record.id] = {.record = record,
                            .is_category = known && model->IsCategory(),
                            .is_cad_model = known && model->kind == ModelKind::kCad,
                            .is_of_photos = video != videos.end() && video->is_of_photos};
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
                     const std::function<void(const VideoRecord&, const std::string&)>& warn) {
  std::vector<std::pair<VideoRecord, std::string>> warnings;
  VICTORIOUS_RETURN_IF_ERROR(store.UpdateObjects([&] {
    warnings.clear();
    return MakeObjects(options, store, cache, [&](const VideoRecord& video, const std::string& warning) {
      warnings.emplace_back(video, warning);
    });
  }));
  for (const auto& [video, warning] : warnings) warn(video, warning);
  return {};
}

}  // namespace victorious
