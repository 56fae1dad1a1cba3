#include "victorious/place/associate/merge_flights.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "victorious/place/associate/agglomerate.h"
#include "victorious/place/associate/neighbours.h"

namespace victorious {
namespace {

struct ObjectCluster {
  ObjectInFlights flights;
  Whereabouts where;
};

// The rules of merging across flights (agglomerate.h).
class AcrossFlights {
 public:
  AcrossFlights(const FlightRegistrations& registrations, const LinkConstraints& constraints,
                const ObjectOptions& options)
      : registrations_(registrations),
        constraints_(constraints),
        options_(options),
        neighbours_(options.max_merge_distance_m + registrations.MaxOffset_m()) {}

  static std::int64_t Id(const ObjectCluster& cluster) {
    return std::ranges::min(cluster.flights, {}, &ObjectInFlight::id)->id;
  }

  void Add(ObjectCluster& cluster) {
    cluster.where = FindWhereabouts(cluster.flights);
    neighbours_.Add(cluster.where, Id(cluster));
  }

  void Remove(const ObjectCluster& cluster) { neighbours_.Remove(cluster.where, Id(cluster)); }

  [[nodiscard]] std::set<std::int64_t> Near(const ObjectCluster& cluster) const {
    return neighbours_.Near(cluster.where);
  }

  std::optional<double> Distance(const ObjectCluster& a, const ObjectCluster& b) const {
    const bool moves = IsAnyMoving(a.flights) || IsAnyMoving(b.flights);
    double squared_m2 = 0;
    double squared_sigmas = 0;
    int pairs = 0;
    for (const ObjectInFlight* of_a : a.flights) {
      for (const ObjectInFlight* of_b : b.flights) {
        if (of_a->video == of_b->video) return std::nullopt;
        if (constraints_.CannotLink(of_a->tracklets, of_b->tracklets)) return std::nullopt;
        std::optional<PlaceDifference> difference = CompareFlights(*of_a, *of_b, moves);
        if (!difference) continue;
        FlightOffset& apart = difference->offset;
        if (const auto offset = registrations_.Between(of_a->video, of_b->video)) {
          apart.enu_m -= offset->enu_m;
          apart.covariance_m2 += offset->covariance_m2;
        } else {
          apart.covariance_m2 += difference->flights_m2;
        }
        const double sigmas = std::max(difference->change_sigmas, Mahalanobis(apart.enu_m, apart.covariance_m2));
        squared_m2 += apart.enu_m.squaredNorm();
        squared_sigmas += sigmas * sigmas;
        ++pairs;
      }
    }
    if (pairs == 0) return std::nullopt;
    const double sigmas = std::sqrt(squared_sigmas / pairs);
    if (std::sqrt(squared_m2 / pairs) > options_.max_merge_distance_m) return std::nullopt;
    return sigmas <= options_.merge_gate_sigma ? std::optional(sigmas) : std::nullopt;
  }

  static std::optional<ObjectCluster> Join(const ObjectCluster& a, const ObjectCluster& b) {
    ObjectCluster joined{.flights = a.flights, .where = {}};
    std::ranges::copy(b.flights, std::back_inserter(joined.flights));
    std::ranges::sort(joined.flights, {}, &ObjectInFlight::video);
    return joined;
  }

 private:
  const FlightRegistrations& registrations_;
  const LinkConstraints& constraints_;
  const ObjectOptions& options_;
  Neighbours neighbours_;
};

}  // namespace

std::vector<ObjectInFlights> MergeFlights(std::span<const ObjectInFlight* const> objects,
                                          const FlightRegistrations& registrations, const LinkConstraints& constraints,
                                          const ObjectOptions& options) {
  std::vector<ObjectCluster> singles;
  for (const ObjectInFlight* object : objects) singles.push_back({.flights = {object}, .where = {}});
  AcrossFlights rules(registrations, constraints, options);
  std::vector<ObjectInFlights> merged;
  for (ObjectCluster& cluster : Agglomerate(std::move(singles), rules)) merged.push_back(std::move(cluster.flights));
  return merged;
}

}  // namespace victorious
