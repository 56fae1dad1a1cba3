// Private to associate/: finds the objects of several flights that may be one, among many.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "victorious/place/associate/flight_fusion.h"
#include "victorious/place/associate/place_grid.h"

namespace victorious {

/// Where and when an object of one or more flights is seen.
struct Whereabouts {
  std::optional<GeodeticPoint> static_point;  ///< of one that stands
  std::set<std::int64_t> minutes;             ///< UTC; empty without
};

/// @param flights  that see one object; at least one
[[nodiscard]] Whereabouts FindWhereabouts(std::span<const ObjectInFlight* const> flights);

/// The objects of one model: near each other, or, if one moves, of one time.
class Neighbours {
 public:
  /// @param reach_m  of objects that stand
  explicit Neighbours(double reach_m) : static_places_(reach_m) {}

  void Add(const Whereabouts& where, std::int64_t id);
  /// @param where  as it was added
  void Remove(const Whereabouts& where, std::int64_t id);

  /// Ids of added objects, itself, too. Ascending.
  [[nodiscard]] std::set<std::int64_t> Near(const Whereabouts& where) const;

 private:
  using IdsByMinute = std::map<std::int64_t, std::set<std::int64_t>>;

  static void AddOf(const IdsByMinute& ids_by_minute, const Whereabouts& where, std::set<std::int64_t>& near);

  PlaceGrid static_places_;
  IdsByMinute moving_;
  IdsByMinute standing_;
};

}  // namespace victorious
