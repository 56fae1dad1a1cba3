#include "victorious/associate/flight_registration.h"

#include <algorithm>
#include <set>
#include <vector>

#include <Eigen/LU>

#include "victorious/associate/neighbours.h"

namespace victorious {
namespace {

constexpr std::size_t kMinCommonObjects = 3;

// Two objects that may be one.
struct OffsetCandidate {
  std::int64_t first;
  std::int64_t second;
  PlaceDifference difference;
};

// The candidates that agree on an offset, each object once, and the offset by them.
struct OffsetConsensus {
  std::size_t objects = 0;
  double residual = 0;  // sum of squared Mahalanobis distances
  FlightOffset offset;
};

double DistanceOf(const OffsetCandidate& candidate, const FlightOffset& offset) {
  return Mahalanobis(candidate.difference.offset.enu_m - offset.enu_m,
                     candidate.difference.offset.covariance_m2 + offset.covariance_m2);
}

// The posterior of the offset, whose prior is zero within the errors of the flights.
OffsetConsensus FindOffsetConsensus(std::span<const OffsetCandidate> candidates, const FlightOffset& start,
                                    const Eigen::Matrix3d& flights_m2, double gate) {
  struct Agreeing {
    double sigmas;
    const OffsetCandidate* candidate;
  };
  std::vector<Agreeing> agreeing;
  for (const OffsetCandidate& candidate : candidates) {
    const double sigmas = DistanceOf(candidate, start);
    if (sigmas <= gate) agreeing.push_back({sigmas, &candidate});
  }
  std::ranges::stable_sort(agreeing, {}, &Agreeing::sigmas);
  OffsetConsensus consensus;
  std::set<std::int64_t> seen;
  Eigen::Matrix3d information = flights_m2.inverse();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  for (const auto& [sigmas, candidate] : agreeing) {
    if (seen.contains(candidate->first) || seen.contains(candidate->second)) continue;
    seen.insert({candidate->first, candidate->second});
    ++consensus.objects;
    consensus.residual += sigmas * sigmas;
    const Eigen::Matrix3d of_candidate = candidate->difference.offset.covariance_m2.inverse();
    information += of_candidate;
    weighted += of_candidate * candidate->difference.offset.enu_m;
  }
  consensus.offset.covariance_m2 = information.inverse();
  consensus.offset.enu_m = consensus.offset.covariance_m2 * weighted;
  return consensus;
}

bool AreDifferent(const FlightOffset& a, const FlightOffset& b, double gate) {
  return Mahalanobis(a.enu_m - b.enu_m, a.covariance_m2 + b.covariance_m2 +
                                            2 * kMergeSlack_m * kMergeSlack_m * Eigen::Matrix3d::Identity()) > gate;
}

std::optional<FlightOffset> RegisterPair(std::span<const OffsetCandidate> candidates, double gate) {
  std::vector<OffsetConsensus> found;
  for (const OffsetCandidate& seed : candidates) {
    const PlaceDifference& difference = seed.difference;
    const Eigen::Matrix3d flights_m2 = difference.flights_m2 + difference.offset.covariance_m2;
    const OffsetConsensus first = FindOffsetConsensus(candidates, difference.offset, flights_m2, gate);
    found.push_back(FindOffsetConsensus(candidates, first.offset, flights_m2, gate));
  }
  const auto best = std::ranges::min_element(found, [](const OffsetConsensus& a, const OffsetConsensus& b) {
    return a.objects != b.objects ? a.objects > b.objects : a.residual < b.residual;
  });
  if (best == found.end() || best->objects < kMinCommonObjects) return std::nullopt;
  const bool is_ambiguous = std::ranges::any_of(found, [&](const OffsetConsensus& other) {
    return 2 * other.objects >= best->objects && AreDifferent(other.offset, best->offset, gate);
  });
  return is_ambiguous ? std::nullopt : std::optional(best->offset);
}

}  // namespace

void FlightRegistrations::Set(std::int64_t first, std::int64_t second, const FlightOffset& offset) {
  offsets_[{first, second}] = offset;
}

std::optional<FlightOffset> FlightRegistrations::Between(std::int64_t a, std::int64_t b) const {
  const auto found = offsets_.find({std::min(a, b), std::max(a, b)});
  if (found == offsets_.end()) return std::nullopt;
  FlightOffset offset = found->second;
  if (a > b) offset.enu_m = -offset.enu_m;
  return offset;
}

double FlightRegistrations::MaxOffset_m() const {
  double largest_m = 0;
  for (const auto& [flights, offset] : offsets_) largest_m = std::max(largest_m, offset.enu_m.norm());
  return largest_m;
}

FlightRegistrations RegisterFlights(std::span<const ObjectInFlight> objects, double merge_gate_sigma) {
  std::map<std::int64_t, std::vector<const ObjectInFlight*>> of_models;
  for (const ObjectInFlight& object : objects) {
    if (!object.is_category) of_models[object.model].push_back(&object);  // a category is of many objects
  }
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<OffsetCandidate>> of_flights;
  for (const auto& [model, of_model] : of_models) {
    Neighbours neighbours(kMaxFlightOffset_m);
    std::map<std::int64_t, const ObjectInFlight*> by_id;
    for (const ObjectInFlight* object : of_model) {
      const Whereabouts where = FindWhereabouts(std::span(&object, 1));
      for (const std::int64_t id : neighbours.Near(where)) {
        const ObjectInFlight* other = by_id.at(id);
        if (other->video == object->video) continue;
        const ObjectInFlight& first = other->video < object->video ? *other : *object;
        const ObjectInFlight& second = other->video < object->video ? *object : *other;
        const std::optional<PlaceDifference> difference =
            CompareFlights(first, second, first.IsMoving() || second.IsMoving());
        if (!difference || difference->change_sigmas > merge_gate_sigma) continue;
        const Eigen::Matrix3d all_m2 = difference->flights_m2 + difference->offset.covariance_m2;
        if (Mahalanobis(difference->offset.enu_m, all_m2) > merge_gate_sigma) continue;
        of_flights[{first.video, second.video}].push_back({first.id, second.id, *difference});
      }
      neighbours.Add(where, object->id);
      by_id[object->id] = object;
    }
  }
  FlightRegistrations registrations;
  for (const auto& [flights, candidates] : of_flights) {
    if (candidates.size() < kMinCommonObjects) continue;
    if (const auto offset = RegisterPair(candidates, merge_gate_sigma))
      registrations.Set(flights.first, flights.second, *offset);
  }
  return registrations;
}

}  // namespace victorious
