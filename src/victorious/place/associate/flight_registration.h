// Private to associate/: the offset between two flights, by the objects that both see.
//
// All places by one flight are off by nearly the same vector: the errors of its telemetry. One object that two flights
// place 12 m apart may be two; if five objects are 12 m apart by the same vector, it is the flights' offset. Each pair
// of objects of one model, one of each flight, proposes its own difference as the offset; most pairs agree on the true
// one (consensus, as MLESAC in pose/). Its estimate weighs what telemetry says of it: zero, within the errors of the
// flights.
//
// There is none if fewer than three objects agree on it, or if half as many agree on another one, as in a row of equal
// vehicles.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "victorious/place/associate/flight_fusion.h"

namespace victorious {

class FlightRegistrations {
 public:
  /// @param offset  from the place by `first` to that by `second`
  /// @pre first < second
  void Set(std::int64_t first, std::int64_t second, const FlightOffset& offset);

  /// From the place by `a` to the place by `b`; std::nullopt if it is not known.
  [[nodiscard]] std::optional<FlightOffset> Between(std::int64_t a, std::int64_t b) const;

  /// The largest one, m.
  [[nodiscard]] double MaxOffset_m() const;

 private:
  std::map<std::pair<std::int64_t, std::int64_t>, FlightOffset> offsets_;
};

/// A larger offset of two flights is not looked for, m.
inline constexpr double kMaxFlightOffset_m = 30;

/// @param objects           of all flights, by id
/// @param merge_gate_sigma  ObjectOptions
[[nodiscard]] FlightRegistrations RegisterFlights(std::span<const ObjectInFlight> objects, double merge_gate_sigma);

}  // namespace victorious
