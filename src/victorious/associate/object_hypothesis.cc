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

#include "victorious/associate/place_grid.h"

namespace victorious {
namespace {

bool IsInPhotos(const ObjectHypothesis& hypothesis) {
  return std::ranges::any_of(hypothesis.tracklets, &ObservedTracklet::is_of_photos);
}

bool HasCommonFrame(const ObservedTracklet& a, const ObservedTracklet& b) {
  if (a.record.video != b.record.video || a.frames.empty() || b.frames.empty()) return false;
  if (a.frames.back() < b.frames.front() || b.frames.back() < a.frames.front()) return false;
  std::vector<std::int64_t> both;
  std::ranges::set_intersection(a.frames, b.frames, std::back_inserter(both));
  return !both.empty();
}

bool HasCommonFrame(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets, [&](const ObservedTracklet* of_b) { return HasCommonFrame(*of_a, *of_b); });
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

std::optional<Distance> ComputeDistance(ObjectHypothesis& a, ObjectHypothesis& b, const ObjectOptions& options) {
  const bool of_one_flight = HasCommonVideo(a, b) && IsInOneVideo(a) && IsInOneVideo(b);
  const ObjectPlace& of_a = of_one_flight ? a.estimate : AbsolutePlace(a, options);
  const ObjectPlace& of_b = of_one_flight ? b.estimate : AbsolutePlace(b, options);
  if (!of_a.place || !of_b.place) return std::nullopt;
  // Flights have independent common errors, and their clocks differ.
  if (!of_one_flight && (of_a.place->IsMoving() || of_b.place->IsMoving())) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a.place->point);
  const Geolocation at_a = of_one_flight ? PlaceAt(of_a, between_s) : PropagatePlace(*of_a.place, between_s);
  const Geolocation at_b = of_one_flight ? PlaceAt(of_b, between_s) : PropagatePlace(*of_b.place, between_s);
  const double slack_m2 = 2 * kMergeSlack_m * kMergeSlack_m;
  const Eigen::Matrix3d covariance =
      at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + slack_m2 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return Distance{apart.norm(), std::sqrt(apart.dot(covariance.ldlt().solve(apart)))};
}

ObjectHypothesis MergePair(const ObjectHypothesis& a, const ObjectHypothesis& b, const ObjectOptions& options) {
  ObjectHypothesis joined{.tracklets = a.tracklets};
  joined.tracklets.insert(joined.tracklets.end(), b.tracklets.begin(), b.tracklets.end());
  std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  joined.estimate = EstimatePlace(joined, options, IsInOneVideo(joined) ? kFlightErrorFraction : 1);
  if (!IsInOneVideo(joined)) joined.absolute = joined.estimate;
  return joined;
}

// Agglomerative merging of the hypotheses of one model. Only pairs that can pass the gates are measured: those of one
// video, and static ones of any videos within `max_merge_distance_m`.
class Merger {
 public:
  Merger(const std::vector<const ObservedTracklet*>& tracklets, const ObjectOptions& options)
      : options_(options), static_places_(options.max_merge_distance_m) {
    std::set<std::int64_t> videos;
    for (const ObservedTracklet* tracklet : tracklets) videos.insert(tracklet->record.video);
    has_several_videos_ = videos.size() > 1;
    for (const ObservedTracklet* tracklet : tracklets) {
      ObjectHypothesis alone{.tracklets = {tracklet}};
      alone.estimate = EstimatePlace(alone, options_, kFlightErrorFraction);
      MeasureNeighbours(Add(std::move(alone)));
    }
  }

  std::vector<ObjectHypothesis> Run() {
    while (!pairs_.empty()) {
      const Pair nearest = pairs_.top();
      pairs_.pop();
      if (!IsCurrent(nearest)) continue;
      ObjectHypothesis joined = MergePair(Get(nearest.first), Get(nearest.second), options_);
      if (!joined.estimate.place || joined.estimate.inlier_fraction < options_.min_inlier_fraction) continue;
      Remove(nearest.first);
      Remove(nearest.second);
      MeasureNeighbours(Add(std::move(joined)));
    }
    std::vector<ObjectHypothesis> result;
    for (auto& [id, hypothesis] : hypotheses_) result.push_back(std::move(hypothesis));
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

  ObjectHypothesis& Get(std::int64_t id) { return hypotheses_.at(id); }

  bool IsCurrent(const Pair& pair) const {
    const auto first = hypotheses_.find(pair.first);
    const auto second = hypotheses_.find(pair.second);
    return first != hypotheses_.end() && second != hypotheses_.end() &&
           first->second.tracklets.size() == pair.size_of_first &&
           second->second.tracklets.size() == pair.size_of_second;
  }

  // The place of the grid: none for a hypothesis that is merged with those of its own flight only.
  std::optional<GeodeticPoint> StaticPlace(ObjectHypothesis& hypothesis) const {
    if (!has_several_videos_) return std::nullopt;
    const std::optional<Geolocation>& place = AbsolutePlace(hypothesis, options_).place;
    return place && !place->IsMoving() ? std::optional(place->point) : std::nullopt;
  }

  ObjectHypothesis& Add(ObjectHypothesis hypothesis) {
    const std::int64_t id = ObjectId(hypothesis);
    ObjectHypothesis& added = hypotheses_[id] = std::move(hypothesis);
    for (const ObservedTracklet* tracklet : added.tracklets) of_video_[tracklet->record.video].insert(id);
    if (const auto place = StaticPlace(added)) static_places_.Add(*place, id);
    return added;
  }

  void Remove(std::int64_t id) {
    ObjectHypothesis& hypothesis = Get(id);
    for (const ObservedTracklet* tracklet : hypothesis.tracklets) of_video_[tracklet->record.video].erase(id);
    if (const auto place = StaticPlace(hypothesis)) static_places_.Remove(*place, id);
    hypotheses_.erase(id);
  }

  void MeasureNeighbours(ObjectHypothesis& one) {
    std::set<std::int64_t> others;
    for (const ObservedTracklet* tracklet : one.tracklets) {
      const std::set<std::int64_t>& ids = of_video_[tracklet->record.video];
      others.insert(ids.begin(), ids.end());
    }
    if (const auto place = StaticPlace(one)) {
      const std::vector<std::int64_t> near = static_places_.Near(*place);
      others.insert(near.begin(), near.end());
    }
    others.erase(ObjectId(one));
    for (const std::int64_t id : others) Measure(one, Get(id));
  }

  void Measure(ObjectHypothesis& one, ObjectHypothesis& other) {
    if (HasCommonFrame(one, other)) return;
    const bool in_order = ObjectId(one) < ObjectId(other);
    ObjectHypothesis& a = in_order ? one : other;
    ObjectHypothesis& b = in_order ? other : one;
    const std::optional<Distance> distance = ComputeDistance(a, b, options_);
    if (!distance || distance->metres > options_.max_merge_distance_m) return;
    if (distance->sigmas <= options_.merge_gate_sigma)
      pairs_.push({distance->sigmas, ObjectId(a), ObjectId(b), a.tracklets.size(), b.tracklets.size()});
  }

  const ObjectOptions& options_;
  bool has_several_videos_ = false;
  std::map<std::int64_t, ObjectHypothesis> hypotheses_;      // by id
  std::map<std::int64_t, std::set<std::int64_t>> of_video_;  // ids
  PlaceGrid static_places_;                                  // ids
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> pairs_;
};

}  // namespace

std::int64_t ObjectId(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets.front()->record.id; }

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

bool HasCommonVideo(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return std::ranges::any_of(a.tracklets, [&](const ObservedTracklet* of_a) {
    return std::ranges::any_of(b.tracklets,
                               [&](const ObservedTracklet* of_b) { return of_a->record.video == of_b->record.video; });
  });
}

// Videos have no common clock, and photos none at all: an object of several videos or of photos is modelled as static.
ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options, double common_fraction) {
  if (!IsInOneVideo(hypothesis) || IsInPhotos(hypothesis)) options.locate.motion = MotionModel::kStatic;
  return EstimatePlace(CollectObservations(hypothesis), options, common_fraction);
}

const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, const ObjectOptions& options) {
  if (!hypothesis.absolute) hypothesis.absolute = EstimatePlace(hypothesis, options, 1);
  return *hypothesis.absolute;
}

std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets,
                                             const ObjectOptions& options) {
  return Merger(tracklets, options).Run();
}

}  // namespace victorious
