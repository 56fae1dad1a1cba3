// Parses the target of a request: "/api/v1/objects?model=jeep&limit=50" to path segments and query parameters. Accepts
// any bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "victorious/apps/serve/api_error.h"
#include "victorious/geometry/geodesy.h"
#include "victorious/store/triage_store.h"

namespace victorious {

struct RequestTarget {
  std::vector<std::string> segments;                       ///< of the path, decoded; none is empty, "." or ".."
  std::vector<std::pair<std::string, std::string>> query;  ///< decoded, in their order; names are unique
};

/// Errors: kInvalidArgument for a target that does not begin with "/", is longer than 4096 bytes, has an incomplete
/// percent code, a control character, or a segment that would leave its folder.
ApiExpected<RequestTarget> ParseRequestTarget(std::string_view target);

/// Returns the value of an id in a path. Error: kNotFound if it is not a positive integer.
ApiExpected<std::int64_t> ParseId(std::string_view text, std::string_view what);

/// Reads query parameters by name and type. An error names the parameter as its field.
class QueryReader {
 public:
  explicit QueryReader(const RequestTarget& target) : query_(target.query), used_(target.query.size(), false) {}

  [[nodiscard]] std::optional<std::string> Text(std::string_view name);
  /// A finite number in [min, max].
  ApiExpected<std::optional<double>> Number(std::string_view name, double min, double max);
  /// An integer in [min, max].
  ApiExpected<std::optional<std::int64_t>> Integer(std::string_view name, std::int64_t min, std::int64_t max);
  /// "latitude,longitude", degrees; without a height.
  ApiExpected<std::optional<GeodeticPoint>> Place(std::string_view name);
  /// "latitude,longitude,metres", angles in degrees.
  ApiExpected<std::optional<GeoCircle>> Circle(std::string_view name);
  /// "latitude,longitude,latitude,longitude,…", degrees: 3 to 100 corners, of one half of the globe.
  ApiExpected<std::optional<GeoPolygon>> Area(std::string_view name);
  /// Error: kInvalidArgument for a parameter that was never read.
  [[nodiscard]] ApiStatus CheckAllUsed() const;

 private:
  const std::vector<std::pair<std::string, std::string>>& query_;
  std::vector<bool> used_;
};

}  // namespace victorious
