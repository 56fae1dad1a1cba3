#include "victorious/place/associate/object_hypothesis.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "victorious/place/associate/agglomerate.h"
#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/link_constraints.h"

namespace victorious {
namespace {

// The distance of two hypotheses: Euclidean, and Mahalanobis with the errors of both.
struct HypothesisDistance {
  double metres = 0;
  double sigmas = 0;
};

// At the time midway between them.
std::optional<HypothesisDistance> DistanceBetween(const ObjectHypothesis& a, const ObjectHypothesis& b,
                                                  const ObjectPlace& of_a, const ObjectPlace& of_b) {
  if (!of_a.place || !of_b.place) return std::nullopt;
  const bool a_first = FirstTime(a) <= FirstTime(b);
  const double between_s = (LastTime(a_first ? a : b) + FirstTime(a_first ? b : a)) / 2;
  const TangentPlane plane(of_a.place->point);
  const Geolocation at_a = PlaceAt(of_a, between_s);
  const Geolocation at_b = PlaceAt(of_b, between_s);
  const Eigen::Matrix3d covariance = at_a.covariance_enu_m2 + at_b.covariance_enu_m2 + MergeSlackCovariance();
  const Eigen::Vector3d apart = plane.EnuFromGeodetic(at_b.point) - plane.EnuFromGeodetic(at_a.point);
  return HypothesisDistance{apart.norm(), Mahalanobis(apart, covariance)};
}

// Places may be rounded by as much.
constexpr double kRounding_m = 1e-3;

struct FlightCluster {
  ObjectHypothesis hypothesis;
  std::optional<Eigen::Vector3d> static_centre;  // Cartesian coordinates of one that does not move, m
};

// The rules of merging within one flight (agglomerate.h).
class FlightRules {
 public:
  FlightRules(const LinkConstraints& constraints, Fits& fits)
      : constraints_(constraints), fits_(fits), options_(fits.options()) {}

  static std::int64_t Id(const FlightCluster& cluster) { return ObjectId(cluster.hypothesis); }

  void Add(FlightCluster& cluster) {
    ids_.insert(Id(cluster));
    const ObjectPlace& estimate = cluster.hypothesis.estimate;
    if (estimate.place && !estimate.IsMoving())
      cluster.static_centre = EarthCenteredFromGeodetic(estimate.place->point);
  }

  void Remove(const FlightCluster& cluster) { ids_.erase(Id(cluster)); }

  [[nodiscard]] const std::set<std::int64_t>& Near(const FlightCluster& /*cluster*/) const { return ids_; }

  std::optional<double> Distance(FlightCluster& a, FlightCluster& b) {
    if (AreClearlyApart(a, b)) return std::nullopt;
    const std::optional<HypothesisDistance> distance =
        DistanceBetween(a.hypothesis, b.hypothesis, WithPath(a.hypothesis, fits_), WithPath(b.hypothesis, fits_));
    if (!distance || distance->metres > options_.max_merge_distance_m) return std::nullopt;
    if (!(distance->sigmas <= options_.merge_gate_sigma)) return std::nullopt;
    if (constraints_.CannotLink(a.hypothesis.tracklets, b.hypothesis.tracklets)) return std::nullopt;
    if (HasCommonFrame(a.hypothesis, b.hypothesis, fits_)) return std::nullopt;
    return distance->sigmas;
  }

  std::optional<FlightCluster> Join(const FlightCluster& a, const FlightCluster& b) {
    ObjectHypothesis joined{.tracklets = a.hypothesis.tracklets, .estimate = {}, .absolute = {}};
    std::ranges::copy(b.hypothesis.tracklets, std::back_inserter(joined.tracklets));
    std::ranges::sort(joined.tracklets, {}, [](const ObservedTracklet* tracklet) { return tracklet->record.id; });
    joined.estimate = fits_.Relative(joined);
    if (!joined.estimate.place || joined.estimate.inlier_fraction < options_.min_inlier_fraction) return std::nullopt;
    return FlightCluster{.hypothesis = std::move(joined), .static_centre = {}};
  }

 private:
  bool AreClearlyApart(const FlightCluster& a, const FlightCluster& b) const {
    if (!a.static_centre || !b.static_centre) return false;
    return (*a.static_centre - *b.static_centre).norm() > options_.max_merge_distance_m + kRounding_m;
  }

  const LinkConstraints& constraints_;
  Fits& fits_;
  const ObjectOptions& options_;
  std::set<std::int64_t> ids_;
};

}  // namespace

std::int64_t ObjectId(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets.front()->record.id; }

std::int64_t VideoOf(const ObjectHypothesis& hypothesis) { return hypothesis.tracklets.front()->record.video; }

std::vector<BearingObservation> CollectObservations(const ObjectHypothesis& hypothesis) {
  std::vector<BearingObservation> observations;
  for (const ObservedTracklet* tracklet : hypothesis.tracklets) {
    std::ranges::copy(tracklet->observations, std::back_inserter(observations));
  }
  std::ranges::stable_sort(observations, {},
                           [](const BearingObservation& observation) { return observation.line.time_s; });
  return observations;
}

bool HasCommonFrame(const ObservedTracklet& a, const ObservedTracklet& b, Fits& fits) {
  if (a.record.video != b.record.video) return false;
  if (a.record.last_time_s < b.record.first_time_s || b.record.last_time_s < a.record.first_time_s) return false;
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

// Photos have no times: what they show stands.
ObjectPlace EstimatePlace(const ObjectHypothesis& hypothesis, ObjectOptions options, double common_fraction,
                          const std::optional<std::optional<SizeRatio>>& size_ratio) {
  if (hypothesis.tracklets.front()->is_of_photos) options.locate.motion = MotionModel::kStatic;
  return EstimatePlace(CollectObservations(hypothesis), options, common_fraction, size_ratio);
}

const ObjectPlace& AbsolutePlace(ObjectHypothesis& hypothesis, Fits& fits) {
  if (!hypothesis.absolute) hypothesis.absolute = fits.Absolute(hypothesis);
  return *hypothesis.absolute;
}

const ObjectPlace& WithPath(ObjectHypothesis& hypothesis, Fits& fits) {
  ObjectPlace& estimate = hypothesis.estimate;
  if (estimate.HasPath() && estimate.path.empty()) estimate.path = fits.Path(hypothesis);
  return estimate;
}

std::vector<ObjectHypothesis> MergeTracklets(const std::vector<const ObservedTracklet*>& tracklets,
                                             const LinkConstraints& constraints, Fits& fits) {
  std::map<std::int64_t, std::vector<FlightCluster>> of_video;
  for (const ObservedTracklet* tracklet : tracklets) {
    ObjectHypothesis alone{.tracklets = {tracklet}, .estimate = {}, .absolute = {}};
    alone.estimate = fits.Relative(alone);
    of_video[tracklet->record.video].push_back({.hypothesis = std::move(alone), .static_centre = {}});
  }
  std::vector<ObjectHypothesis> hypotheses;
  for (auto& [video, singles] : of_video) {
    FlightRules rules(constraints, fits);
    for (FlightCluster& cluster : Agglomerate(std::move(singles), rules))
      hypotheses.push_back(std::move(cluster.hypothesis));
  }
  std::ranges::sort(hypotheses, {}, ObjectId);
  return hypotheses;
}

}  // namespace victorious
