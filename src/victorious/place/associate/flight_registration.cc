#include "victorious/place/associate/flight_registration.h"

#include <algorithm>
#include <ranges>
#include <vector>

#include <Eigen/LU>

#include "victorious/place/associate/neighbours.h"

namespace victorious {
namespace {

constexpr std::size_t kMinCommonObjects = 3;

// Two objects that may be one.
struct OffsetCandidate {
  std::int64_t first;
  std::int64_t second;
  PlaceDifference difference;
  Eigen::Matrix3d information;  // inverse of the covariance of its offset
};

// The candidates that agree on an offset, each object once, and the offset by them.
struct OffsetConsensus {
  std::size_t objects = 0;
  double residual = 0;  // sum of squared Mahalanobis distances
  FlightOffset offset;
};

// std::nullopt beyond the gate.
std::optional<double> DistanceWithin(double gate, const OffsetCandidate& candidate, const FlightOffset& offset) {
  // No eigenvalue of a covariance is larger than its trace: most candidates are excluded without solving.
  const double trace_m2 = candidate.difference.offset.covariance_m2.trace() + offset.covariance_m2.trace();
  if ((candidate.difference.offset.enu_m - offset.enu_m).squaredNorm() > gate * gate * trace_m2) return std::nullopt;
  const double sigmas = Mahalanobis(candidate.difference.offset.enu_m - offset.enu_m,
                                    candidate.difference.offset.covariance_m2 + offset.covariance_m2);
  return sigmas <= gate ? std::optional(sigmas) : std::nullopt;
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
    if (const auto sigmas = DistanceWithin(gate, candidate, start)) agreeing.push_back({*sigmas, &candidate});
  }
  std::ranges::stable_sort(agreeing, {}, &Agreeing::sigmas);
  OffsetConsensus consensus;
  std::vector<std::int64_t> seen;
  const auto is_seen = [&](std::int64_t id) { return std::ranges::find(seen, id) != seen.end(); };
  Eigen::Matrix3d information = flights_m2.inverse();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  for (const auto& [sigmas, candidate] : agreeing) {
    if (is_seen(candidate->first) || is_seen(candidate->second)) continue;
    seen.insert(seen.end(), {candidate->first, candidate->second});
    ++consensus.objects;
    consensus.residual += sigmas * sigmas;
    information += candidate->information;
    weighted += candidate->information * candidate->difference.offset.enu_m;
  }
  consensus.offset.covariance_m2 = information.inverse();
  consensus.offset.enu_m = consensus.offset.covariance_m2 * weighted;
  return consensus;
}

bool AreDifferent(const FlightOffset& a, const FlightOffset& b, double gate) {
  return Mahalanobis(a.enu_m - b.enu_m, a.covariance_m2 + b.covariance_m2 + MergeSlackCovariance()) > gate;
}

std::optional<FlightOffset> RegisterPair(std::span<const OffsetCandidate> candidates, double gate) {
  struct Seed {
    Eigen::Matrix3d flights_m2;
    OffsetConsensus consensus;
  };
  std::vector<Seed> seeds;
  for (const OffsetCandidate& candidate : candidates) {
    const PlaceDifference& difference = candidate.difference;
    Seed seed{.flights_m2 = difference.flights_m2 + difference.offset.covariance_m2, .consensus = {}};
    seed.consensus = FindOffsetConsensus(candidates, difference.offset, seed.flights_m2, gate);
    seeds.push_back(seed);
  }
  const auto objects_of = [](const Seed& seed) { return seed.consensus.objects; };
  const std::size_t most = std::ranges::max(seeds | std::views::transform(objects_of));
  if (most < kMinCommonObjects) return std::nullopt;
  std::erase_if(seeds, [&](const Seed& seed) { return 2 * seed.consensus.objects < most; });
  for (Seed& seed : seeds)
    seed.consensus = FindOffsetConsensus(candidates, seed.consensus.offset, seed.flights_m2, gate);
  const OffsetConsensus best = std::ranges::min(seeds, [](const Seed& a, const Seed& b) {
                                 return std::pair(b.consensus.objects, a.consensus.residual) <
                                        std::pair(a.consensus.objects, b.consensus.residual);
                               }).consensus;
  const bool is_ambiguous = std::ranges::any_of(seeds, [&](const Seed& other) {
    return 2 * other.consensus.objects >= best.objects && AreDifferent(other.consensus.offset, best.offset, gate);
  });
  return is_ambiguous || best.objects < kMinCommonObjects ? std::nullopt : std::optional(best.offset);
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
        of_flights[{first.video, second.video}].push_back(
            {first.id, second.id, *difference, difference->offset.covariance_m2.inverse()});
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
