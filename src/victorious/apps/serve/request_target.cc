#include "victorious/apps/serve/request_target.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxTargetBytes = 4096;

std::unexpected<ApiError> BadTarget(std::string_view why) {
  return std::unexpected(ApiError(Error{ErrorCode::kInvalidArgument, fmt::format("the address {}", why)}));
}

std::optional<int> HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

// Decodes %XX, and in a query "+" as a space.
ApiExpected<std::string> Decode(std::string_view text, bool is_query) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const auto high = i + 2 < text.size() ? HexDigit(text[i + 1]) : std::nullopt;
      const auto low = i + 2 < text.size() ? HexDigit(text[i + 2]) : std::nullopt;
      if (!high || !low) return BadTarget("has a % that is not followed by two hexadecimal digits");
      c = static_cast<char>(*high * 16 + *low);
      i += 2;
    } else if (c == '+' && is_query) {
      c = ' ';
    }
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return BadTarget("has a control character");
    decoded += c;
  }
  return decoded;
}

// Parses a whole text as a number.
template <typename Number>
std::optional<Number> ParseExactly(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// As many finite numbers between commas.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> ReadNumbers(std::string_view text) {
  std::array<double, kCount> numbers{};
  if (std::ranges::count(text, ',') != kCount - 1) return std::nullopt;
  for (double& number : numbers) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    const auto value = ParseExactly<double>(part);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    number = *value;
  }
  return numbers;
}

bool IsPlace(double latitude_deg, double longitude_deg) {
  return std::abs(latitude_deg) <= 90 && std::abs(longitude_deg) <= 360;
}

}  // namespace

ApiExpected<RequestTarget> ParseRequestTarget(std::string_view target) {
  if (target.empty() || target.front() != '/') return BadTarget("must begin with /");
  if (target.size() > kMaxTargetBytes) return BadTarget(fmt::format("has more than {} bytes", kMaxTargetBytes));
  RequestTarget parsed;
  const std::size_t question = target.find('?');
  std::string_view path = target.substr(1, question == std::string_view::npos ? question : question - 1);
  while (!path.empty()) {
    const std::string_view part = path.substr(0, path.find('/'));
    path.remove_prefix(std::min(part.size() + 1, path.size()));
    VICTORIOUS_ASSIGN_OR_RETURN(std::string segment, Decode(part, /*is_query=*/false));
    if (segment.empty() || segment == "." || segment == ".." || segment.find_first_of("/\\") != std::string::npos) {
      return BadTarget("has an empty part, \".\", \"..\" or an encoded slash");
    }
    parsed.segments.push_back(std::move(segment));
  }
  std::string_view query = question == std::string_view::npos ? "" : target.substr(question + 1);
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(part.size() + 1, query.size()));
    if (part.empty()) continue;
    const std::size_t equals = std::min(part.find('='), part.size());
    VICTORIOUS_ASSIGN_OR_RETURN(std::string name, Decode(part.substr(0, equals), /*is_query=*/true));
    VICTORIOUS_ASSIGN_OR_RETURN(std::string value,
                                Decode(part.substr(std::min(equals + 1, part.size())), /*is_query=*/true));
    if (std::ranges::find(parsed.query, name, &std::pair<std::string, std::string>::first) != parsed.query.end()) {
      return FailField(name, fmt::format("{}: given twice: give it once", name));
    }
    parsed.query.emplace_back(std::move(name), std::move(value));
  }
  return parsed;
}

ApiExpected<std::int64_t> ParseId(std::string_view text, std::string_view what) {
  const auto id = ParseExactly<std::int64_t>(text);
  if (id && *id >= 0) return *id;
  return std::unexpected(ApiError(Error{ErrorCode::kNotFound, fmt::format("{}: no such {}", text, what)}));
}

std::optional<std::string> QueryReader::Text(std::string_view name) {
  for (std::size_t i = 0; i < query_.size(); ++i) {
    if (query_[i].first != name) continue;
    used_[i] = true;
    return query_[i].second;
  }
  return std::nullopt;
}

ApiExpected<std::optional<double>> QueryReader::Number(std::string_view name, double min, double max) {
  const auto text = Text(name);
  if (!text) return std::nullopt;
  const auto value = ParseExactly<double>(*text);
  if (value && *value >= min && *value <= max) return value;
  return FailField(std::string(name),
                   fmt::format("{} \"{}\": must be a number from {:g} to {:g}", name, *text, min, max));
}

ApiExpected<std::optional<std::int64_t>> QueryReader::Integer(std::string_view name, std::int64_t min,
                                                              std::int64_t max) {
  const auto text = Text(name);
  if (!text) return std::nullopt;
  const auto value = ParseExactly<std::int64_t>(*text);
  if (value && *value >= min && *value <= max) return value;
  return FailField(std::string(name),
                   fmt::format("{} \"{}\": must be an integer from {} to {}", name, *text, min, max));
}

ApiExpected<std::optional<GeodeticPoint>> QueryReader::Place(std::string_view name) {
  const auto text = Text(name);
  if (!text) return std::nullopt;
  const auto numbers = ReadNumbers<2>(*text);
  if (numbers && IsPlace((*numbers)[0], (*numbers)[1])) {
    return GeodeticPoint{RadiansFromDegrees((*numbers)[0]), RadiansFromDegrees((*numbers)[1]), 0};
  }
  return FailField(std::string(name),
                   fmt::format("{} \"{}\": must be latitude and longitude in degrees, as in 52.52,13.40", name, *text));
}

ApiExpected<std::optional<GeoCircle>> QueryReader::Circle(std::string_view name) {
  const auto text = Text(name);
  if (!text) return std::nullopt;
  const auto numbers = ReadNumbers<3>(*text);
  if (numbers && IsPlace((*numbers)[0], (*numbers)[1]) && (*numbers)[2] >= 0) {
    return GeoCircle{{RadiansFromDegrees((*numbers)[0]), RadiansFromDegrees((*numbers)[1]), 0}, (*numbers)[2]};
  }
  return FailField(std::string(name),
                   fmt::format("{} \"{}\": must be latitude and longitude in degrees and a distance in metres, as in "
                               "52.52,13.40,50",
                               name, *text));
}

ApiExpected<std::optional<GeoPolygon>> QueryReader::Area(std::string_view name) {
  constexpr std::size_t kMaxCorners = 100;
  const auto text = Text(name);
  if (!text) return std::nullopt;
  std::vector<double> numbers;
  bool is_valid = true;
  for (std::string_view rest = *text; is_valid && !rest.empty();) {
    const auto value = ParseExactly<double>(rest.substr(0, rest.find(',')));
    is_valid = value && std::isfinite(*value) && numbers.size() < 2 * kMaxCorners;
    if (is_valid) numbers.push_back(*value);
    const auto comma = rest.find(',');
    is_valid = is_valid && comma != rest.size() - 1;
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  is_valid = is_valid && numbers.size() >= 6 && numbers.size() % 2 == 0;
  GeoPolygon area;
  for (std::size_t i = 0; is_valid && i < numbers.size(); i += 2) {
    // Farther than a quarter of a turn from the first corner, which way round an edge goes would be a guess.
    is_valid = std::abs(numbers[i]) <= 90 && std::abs(numbers[i + 1]) <= 360 &&
               std::abs(std::remainder(numbers[i + 1] - numbers[1], 360)) <= 90;
    area.corners.push_back({RadiansFromDegrees(numbers[i]), RadiansFromDegrees(numbers[i + 1]), 0});
  }
  if (is_valid) return area;
  return FailField(std::string(name),
                   fmt::format("{} \"{}\": must be latitude and longitude in degrees of 3 to {} corners, as in "
                               "52.5,13.4,52.6,13.4,52.6,13.5",
                               name, *text, kMaxCorners));
}

ApiStatus QueryReader::CheckAllUsed() const {
  for (std::size_t i = 0; i < query_.size(); ++i) {
    if (used_[i]) continue;
    return FailField(query_[i].first, fmt::format("{}: not a parameter of this address", query_[i].first));
  }
  return {};
}

}  // namespace victorious
