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

// Distance of two hypotheses at the time midway between them: Euclidean and Mahalanobis.
struct Distance {
  double metres = 0;
  double sigmas = 0;
};

bool AreOfOneFlight(const ObjectHypothesis& a, const ObjectHypothesis& b) {
  return HasCommonVideo(a, b) && IsInOneVideo(a) && IsInOneVideo(b);
}

// The estimate for comparisons within its flight, with its path.
const ObjectPlace& WithPath(ObjectHypothesis& hypothesis, Fits& fits) {
  ObjectPlace& estimate = hypothesis.estimate;
  if (estimate.HasPath() && estimate.path.empty()) estimate.path = fits.Path(hypothesis);
  return estimate;
}

std::optional<Distance> ComputeDistance(ObjectHypothesis& a, ObjectHypothesis& b, Fits& fits) {
  const bool of_one_flight = AreOfOneFlight(a, b);
  const ObjectPlace& of_a = of_one_flight ? WithPath(a, fits) : AbsolutePlace(a, fits);
  const ObjectPlace& of_b = of_one_flight ? WithPath(b, fits) : AbsolutePlace(b, fits);
  if (!of_a.place || !of_b.place) return std::nullopt;
  // Flights have independent common errors, and their clocks differ.
  if (!of_one_flight && (of_a.place->IsMoving() || of_b.place->IsMoving())) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a.place->point);
  const Geolocation at_a = of_one_flight ? PlaceAt(of_a, between_s) : PredictPlace(*of_a.place, between_s);
  const Geolocation at_b = of_one_flight ? PlaceAt(of_b, between_s) : PredictPlace(*of_b.place, between_s);
  const double slack_m2 = 2 * kMergeSlack_m * kMergeSlack_m;
  const Eigen::Matrix3d covariance =
      at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + slack_m2 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return Distance{apart.norm(), std::sqrt(apart.dot(covariance.ldlt().solve(apart)))};
}

ObjectHypothesis MergePair(const ObjectHypothesis& a, const ObjectHypothesis& b, Fits& fits) {
  ObjectHypothesis joined{.tracklets = a.tracklets};
  joined.tracklets.insert(joined.tracklets.end(), b.tracklets.begin(), b.tracklets.end());
  std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
  joined.estimate = fits.Relative(joined);
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

// Agglomerative merging of the hypotheses of one model. Only pairs that can pass the gates are measured: those of one
// video, and static ones of any videos within `max_merge_distance_m`.
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
    return added;
  }

  void Remove(std::int64_t id) {
    ObjectHypothesis& hypothesis = Get(id).hypothesis;
    if (IsInOneVideo(hypothesis)) of_flight_[VideoOf(hypothesis)].erase(id);
    if (const auto place = StaticPlace(hypothesis)) static_places_.Remove(*place, id);
    nodes_.erase(id);
  }

  static std::int64_t VideoOf(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets[0]->record.video; }

  // Those of its flight, and static ones nearby. One of several videos is compared as a static one.
  void MeasureNeighbours(Node& one) {
    std::vector<std::int64_t> others;
    if (const auto place = StaticPlace(one.hypothesis)) others = static_places_.Near(*place);
    if (IsInOneVideo(one.hypothesis)) {
      const std::set<std::int64_t>& of_flight = of_flight_[VideoOf(one.hypothesis)];
      others.insert(others.end(), of_flight.begin(), of_flight.end());
      std::ranges::sort(others);
      const auto repeated = std::ranges::unique(others);
      others.erase(repeated.begin(), repeated.end());
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
    const std::optional<Distance> distance = ComputeDistance(a, b, fits_);
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

// Videos have no common clock, and photos none at all: an object of several videos or of photos is modelled as static.
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
