#include "victorious/associate/object_hypothesis.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Cholesky>

#include "victorious/associate/fits.h"
#include "victorious/associate/place_grid.h"

namespace victorious {
namespace {

// UTC minus the video's time, s since 1970. @pre the tracklet has start_utc_us
double UtcOffset(const ObservedTracklet& tracklet) { return 1e-6 * static_cast<double>(*tracklet.start_utc_us); }

bool IsInPhotos(const ObjectHypothesis& hypothesis) {
  return std::ranges::any_of(hypothesis.tracklets, &ObservedTracklet::is_of_photos);
}

bool HasCommonFrame(const ObservedTracklet& a, const ObservedTracklet& b, Fits& fits) {
  if (a.record.video != b.record.video) return false;
  const std::vector<std::int64_t>& of_a = fits.Frames(a);
  const std::vector<std::int64_t>& of_b = fits.Frames(b);
  if (of_a.empty() || of_b.empty()) return false;
  if (of_a.back() < of_b.front() || of_b.back() < of_a.front()) return false;
  std::vector<std::int64_t> both;
  std::ranges::set_intersection(of_a, of_b, std::back_inserter(both));
  return !both.empty();
}

bool HasCommonFrame(const ObjectHypothesis& a, const ObjectHypothesis& b, Fits& fits) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets,
                               [&](const ObservedTracklet* of_b) { return HasCommonFrame(*of_a, *of_b, fits); });
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

bool AreOfOneFlight(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return HasCommonVideo(a, b) && IsInOneVideo(a) && IsInOneVideo(b);
}

// The estimate for comparisons within its flight, with its path.
const ObjectPlace& WithPath(ObjectHypothesis& hypothesis, Fits& fits) {
  ObjectPlace& estimate = hypothesis.estimate;
  if (estimate.HasPath() && estimate.path.empty()) estimate.path = fits.Path(hypothesis);
  return estimate;
}

// At the time midway between them.
std::optional<HypothesisDistance> DistanceBetween(const ObjectHypothesis& a, const ObjectHypothesis& b,
                                                  const ObjectPlace& of_a, const ObjectPlace& of_b) {
  if (!of_a.place || !of_b.place) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a.place->point);
  const Geolocation at_a = PlaceAt(of_a, between_s);
  const Geolocation at_b = PlaceAt(of_b, between_s);
  const double slack_m2 = 2 * kMergeSlack_m * kMergeSlack_m;
  const Eigen::Matrix3d covariance =
      at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + slack_m2 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return HypothesisDistance{apart.norm(), std::sqrt(apart.dot(covariance.ldlt().solve(apart)))};
}

// The largest distance between their flights.
std::optional<HypothesisDistance> DistanceInMotion(const ObjectHypothesis& a, const ObjectHypothesis& b, Fits& fits) {
  std::vector<ObjectHypothesis> flights_of_a = SplitByVideo(a, fits);
  std::vector<ObjectHypothesis> flights_of_b = SplitByVideo(b, fits);
  HypothesisDistance largest;
  for (ObjectHypothesis& of_a : flights_of_a) {
    for (ObjectHypothesis& of_b : flights_of_b) {
      std::optional<HypothesisDistance> distance;
      if (HasCommonVideo(of_a, of_b)) {
        distance = DistanceBetween(of_a, of_b, WithPath(of_a, fits), WithPath(of_b, fits));
      } else {
        const std::optional<ObjectInFlight> one = MakeObjectInFlight(of_a, fits);
        const std::optional<ObjectInFlight> other = MakeObjectInFlight(of_b, fits);
        if (one && other) distance = CompareFlights(*one, *other);
      }
      if (!distance) return std::nullopt;
      largest.metres = std::max(largest.metres, distance->metres);
      largest.sigmas = std::max(largest.sigmas, distance->sigmas);
    }
  }
  return largest;
}

std::optional<HypothesisDistance> ComputeDistance(ObjectHypothesis& a, ObjectHypothesis& b, Fits& fits) {
  if (AreOfOneFlight(a, b)) return DistanceBetween(a, b, WithPath(a, fits), WithPath(b, fits));
  if (IsMoving(a) || IsMoving(b)) return DistanceInMotion(a, b, fits);
  return DistanceBetween(a, b, AbsolutePlace(a, fits), AbsolutePlace(b, fits));
}

// The estimate by several flights of an object that moves. Without a place if one flight has none.
ObjectPlace EstimateInMotion(const ObjectHypothesis& hypothesis, Fits& fits) {
  std::vector<ObjectInFlight> flights;
  for (ObjectHypothesis& of_one_video : SplitByVideo(hypothesis, fits)) {
    std::optional<ObjectInFlight> flight = MakeObjectInFlight(of_one_video, fits);
    if (!flight) return {};
    flights.push_back(*std::move(flight));
  }
  return FuseFlights(flights);
}

ObjectHypothesis MergePair(const ObjectHypothesis& a, const ObjectHypothesis& b, Fits& fits) {
  ObjectHypothesis joined{.tracklets = a.tracklets};
  joined.tracklets.insert(joined.tracklets.end(), b.tracklets.begin(), b.tracklets.end());
  std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  const bool is_joint_motion = !IsInOneVideo(joined) && (IsMoving(a) || IsMoving(b));
  joined.estimate = is_joint_motion ? EstimateInMotion(joined, fits) : fits.Relative(joined);
  if (!IsInOneVideo(joined)) joined.absolute = joined.estimate;
  return joined;
}

// Places may be rounded by as much.
constexpr double kRounding_m = 1e-3;

// The Cartesian coordinates of an object that does not move, for comparisons within its flight.
std::optional<Eigen::Vector3d> StaticCentre(const ObjectPlace& estimate) {
  if (!estimate.place || estimate.place->IsMoving() || estimate.HasPath()) return std::nullopt;
  return EarthCenteredFromGeodetic(estimate.place->point);
}

// The hypotheses by the time of their sightings, UTC. An object that moves is compared with those of other flights of
// its time.
class TimeTable {
 public:
  void Add(const ObjectHypothesis& hypothesis) {
    for (const std::int64_t minute : MinutesOf(hypothesis)) ids_[minute].insert(ObjectId(hypothesis));
  }

  void Remove(const ObjectHypothesis& hypothesis) {
    for (const std::int64_t minute : MinutesOf(hypothesis)) ids_[minute].erase(ObjectId(hypothesis));
  }

  // Ascending; itself, too. Empty without UTC.
  [[nodiscard]] std::set<std::int64_t> Near(const ObjectHypothesis& hypothesis) const {
    std::set<std::int64_t> near;
    for (const std::int64_t minute : MinutesOf(hypothesis)) {
      if (const auto found = ids_.find(minute); found != ids_.end())
        near.insert(found->second.begin(), found->second.end());
    }
    return near;
  }

 private:
  static std::set<std::int64_t> MinutesOf(const ObjectHypothesis& hypothesis) {
    constexpr double kMinute_s = 60;
    std::set<std::int64_t> minutes;
    for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
      if (!tracklet->start_utc_us || tracklet->is_of_photos) continue;
      const double start_s = UtcOffset(*tracklet);
      const auto minute = [&](double time_s) {
        return static_cast<std::int64_t>(std::floor((start_s + time_s) / kMinute_s));
      };
      const std::int64_t last = minute(tracklet->record.last_time_s + kMaxFlightGap_s / 2);
      for (std::int64_t m = minute(tracklet->record.first_time_s - kMaxFlightGap_s / 2); m <= last; ++m)
        minutes.insert(m);
    }
    return minutes;
  }

  std::map<std::int64_t, std::set<std::int64_t>> ids_;
};

// Agglomerative merging of the hypotheses of one model. Only pairs that can pass the gates are measured: those of one
// video, static ones of any videos within `max_merge_distance_m`, and, if one moves, those of videos of one time.
class Merger {
 public:
  Merger(const std::vector<const ObservedTracklet*>& tracklets, Fits& fits)
      : fits_(fits), options_(fits.options()), static_places_(options_.max_merge_distance_m) {
    std::set<std::int64_t> videos;
    for (const ObservedTracklet* tracklet : tracklets) videos.insert(tracklet->record.video);
    has_several_videos_ = videos.size() > 1;
    for (const ObservedTracklet* tracklet : tracklets) {
      ObjectHypothesis alone{.tracklets = {tracklet}, .estimate = {}, .absolute = {}};
      alone.estimate = fits_.Relative(alone);
      MeasureNeighbours(Add(std::move(alone)));
    }
  }

  std::vector<ObjectHypothesis> Run() {
    while (!pairs_.empty()) {
      const Pair nearest = pairs_.top();
      pairs_.pop();
      if (!IsCurrent(nearest)) continue;
      ObjectHypothesis joined = MergePair(Get(nearest.first).hypothesis, Get(nearest.second).hypothesis, fits_);
      if (!joined.estimate.place || joined.estimate.inlier_fraction < options_.min_inlier_fraction) continue;
      Remove(nearest.first);
      Remove(nearest.second);
      MeasureNeighbours(Add(std::move(joined)));
    }
    std::vector<ObjectHypothesis> result;
    for (auto& [id, node] : nodes_) result.push_back(std::move(node.hypothesis));
    return result;
  }

 private:
  // Two hypotheses that pass the gates. A hypothesis that grew has another number of tracklets.
  struct Pair {
    double sigmas;
    std::int64_t first;  // the smaller id
    std::int64_t second;
    std::size_t size_of_first;
    std::size_t size_of_second;

    bool operator>(const Pair& other) const {
      return std::tie(sigmas, first, second) > std::tie(other.sigmas, other.first, other.second);
    }
  };

  struct Node {
    ObjectHypothesis hypothesis;
    std::optional<Eigen::Vector3d> static_centre;  // of one of a single video
  };

  Node& Get(std::int64_t id) { return nodes_.at(id); }

  bool IsCurrent(const Pair& pair) const {
    const auto first = nodes_.find(pair.first);
    const auto second = nodes_.find(pair.second);
    return first != nodes_.end() && second != nodes_.end() &&
           first->second.hypothesis.tracklets.size() == pair.size_of_first &&
           second->second.hypothesis.tracklets.size() == pair.size_of_second;
  }

  // The place of the grid: none for a hypothesis that is merged with those of its own flight only.
  std::optional<GeodeticPoint> StaticPlace(ObjectHypothesis& hypothesis) {
    if (!has_several_videos_) return std::nullopt;
    const std::optional<Geolocation>& place = AbsolutePlace(hypothesis, fits_).place;
    return place && !place->IsMoving() ? std::optional(place->point) : std::nullopt;
  }

  Node& Add(ObjectHypothesis hypothesis) {
    const std::int64_t id = ObjectId(hypothesis);
    Node& added = nodes_[id] = {.hypothesis = std::move(hypothesis), .static_centre = {}};
    if (IsInOneVideo(added.hypothesis)) {
      added.static_centre = StaticCentre(added.hypothesis.estimate);
      of_flight_[VideoOf(added.hypothesis)].insert(id);
    }
    if (const auto place = StaticPlace(added.hypothesis)) static_places_.Add(*place, id);
    if (has_several_videos_) by_time_.Add(added.hypothesis);
    return added;
  }

  void Remove(std::int64_t id) {
    ObjectHypothesis& hypothesis = Get(id).hypothesis;
    if (IsInOneVideo(hypothesis)) of_flight_[VideoOf(hypothesis)].erase(id);
    if (const auto place = StaticPlace(hypothesis)) static_places_.Remove(*place, id);
    if (has_several_videos_) by_time_.Remove(hypothesis);
    nodes_.erase(id);
  }

  static std::int64_t VideoOf(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets[0]->record.video; }

  // Those of its flight, static ones nearby, and, if one of both moves, those of its time.
  void MeasureNeighbours(Node& one) {
    std::set<std::int64_t> others;
    if (const auto place = StaticPlace(one.hypothesis)) {
      const std::vector<std::int64_t> near = static_places_.Near(*place);
      others.insert(near.begin(), near.end());
    }
    if (IsInOneVideo(one.hypothesis)) {
      const std::set<std::int64_t>& of_flight = of_flight_[VideoOf(one.hypothesis)];
      others.insert(of_flight.begin(), of_flight.end());
    }
    for (const std::int64_t id : by_time_.Near(one.hypothesis)) {
      if (IsMoving(one.hypothesis) || IsMoving(Get(id).hypothesis)) others.insert(id);
    }
    for (const std::int64_t id : others) {
      if (id != ObjectId(one.hypothesis)) Measure(one, Get(id));
    }
  }

  bool AreClearlyApart(const Node& one, const Node& other) const {
    if (!one.static_centre || !other.static_centre || !AreOfOneFlight(one.hypothesis, other.hypothesis)) return false;
    return (*one.static_centre - *other.static_centre).norm() > options_.max_merge_distance_m + kRounding_m;
  }

  void Measure(Node& one, Node& other) {
    if (AreClearlyApart(one, other)) return;
    const bool in_order = ObjectId(one.hypothesis) < ObjectId(other.hypothesis);
    ObjectHypothesis& a = (in_order ? one : other).hypothesis;
    ObjectHypothesis& b = (in_order ? other : one).hypothesis;
    const std::optional<HypothesisDistance> distance = ComputeDistance(a, b, fits_);
    if (!distance || distance->metres > options_.max_merge_distance_m) return;
    if (!(distance->sigmas <= options_.merge_gate_sigma) || HasCommonFrame(a, b, fits_)) return;
    pairs_.push({distance->sigmas, ObjectId(a), ObjectId(b), a.tracklets.size(), b.tracklets.size()});
  }

  Fits& fits_;
  const ObjectOptions& options_;
  bool has_several_videos_ = false;
  std::map<std::int64_t, Node> nodes_;                        // by id
  std::map<std::int64_t, std::set<std::int64_t>> of_flight_;  // ids of those of one video
  PlaceGrid static_places_;                                   // ids
  TimeTable by_time_;
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> pairs_;
};

}  // namespace

std::int64_t ObjectId(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets.front()->record.id; }

std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis) {
  std::vector<BearingObservation> observations;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    for (BearingObservation observation : tracklet->observations) {
      if (observation.line.clock_shift) observation.line.clock_shift->flight = tracklet->record.video;
      if (observation.line.focal_shift) observation.line.focal_shift->flight = tracklet->record.video;
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

bool HasCommonVideo(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets,
                               [&](const ObservedTracklet* of_b) { return of_a->record.video == of_b->record.video; });
  });
}

bool IsMoving(const ObjectHypothesis& hypothesis) {
  const ObjectPlace& estimate = hypothesis.estimate;
  return estimate.place && (estimate.place->IsMoving() || estimate.HasPath());
}

std::vector<ObjectHypothesis> SplitByVideo(const ObjectHypothesis& hypothesis, Fits& fits) {
  if (IsInOneVideo(hypothesis)) return {hypothesis};
  std::map<std::int64_t, ObjectHypothesis> by_video;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets)
    by_video[tracklet->record.video].tracklets.push_back(tracklet);
  std::vector<ObjectHypothesis> parts;
  for (auto& [video, part] : by_video) {
    part.estimate = fits.Relative(part);
    parts.push_back(std::move(part));
  }
  return parts;
}

std::optional<ObjectInFlight> MakeObjectInFlight(ObjectHypothesis& of_one_video, Fits& fits) {
  const ObservedTracklet& tracklet = *of_one_video.tracklets.front();
  const std::optional<Geolocation> absolute = AbsolutePlace(of_one_video, fits).place;
  if (!of_one_video.estimate.place || !absolute || !tracklet.start_utc_us || tracklet.is_of_photos) return std::nullopt;
  ObjectInFlight flight{
      .relative = WithPath(of_one_video, fits), .absolute = *absolute, .utc_offset_s = UtcOffset(tracklet)};
  flight.first_s = flight.utc_offset_s + FirstTime(of_one_video);
  flight.last_s = flight.utc_offset_s + LastTime(of_one_video);
  for (const ObservedTracklet* one : of_one_video.tracklets)
    flight.observations += static_cast<double>(one->summary.observations);
  return flight;
}

// A fit of several videos, or of photos, is that of an object that stands: they have no common clock, and photos none
// at all. One that moves is estimated for each flight (joint_motion.h).
ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options, double common_fraction,
                          const std::optional<std::optional<SizeRatio>>& size_ratio) {
  if (!IsInOneVideo(hypothesis) || IsInPhotos(hypothesis)) options.locate.motion = MotionModel::kStatic;
  return EstimatePlace(CollectObservations(hypothesis), options, common_fraction, size_ratio);
}

const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, Fits& fits) {
  if (!hypothesis.absolute) hypothesis.absolute = fits.Absolute(hypothesis);
  return *hypothesis.absolute;
}

std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets, Fits& fits) {
  return Merger(tracklets, fits).Run();
}

}  // namespace victorious
