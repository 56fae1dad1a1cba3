// Fuzzes the readers of kept fits, whose bytes come from the index: bytes are refused, or are those that the writer
// makes of what was read, with places that can be used.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/place/associate/packed_fit.h"

namespace {

using victorious::FlightFits;
using victorious::Geolocation;
using victorious::HeadingError;
using victorious::HypothesisFits;
using victorious::ObjectPlace;
using victorious::Pack;
using victorious::RangeFactor;

void CheckPlace(const ObjectPlace& place) {
  VICTORIOUS_CHECK(!place.HasPath() || place.place);
  if (place.place)
    VICTORIOUS_CHECK(victorious::PropagatePlace(*place.place, place.place->time_s).covariance_enu_m2.allFinite());
}

void CheckBytes(const std::vector<std::byte>& packed, std::span<const std::byte> bytes) {
  VICTORIOUS_CHECK(packed == std::vector(bytes.begin(), bytes.end()));
}

std::string ToText(const std::vector<std::byte>& bytes) {
  std::string text;
  for (const std::byte byte : bytes) text += static_cast<char>(byte);
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  if (const auto fits = victorious::UnpackHypothesisFits(bytes)) {
    if (fits->relative) CheckPlace(*fits->relative);
    if (fits->absolute) CheckPlace(*fits->absolute);
    if (fits->on_level) CheckPlace(fits->on_level->place.relative);
    CheckBytes(Pack(*fits), bytes);
  }
  if (const auto flight = victorious::UnpackFlightFits(bytes)) CheckBytes(Pack(*flight), bytes);
  if (const auto path = victorious::UnpackPath(bytes)) CheckBytes(Pack(*path), bytes);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  Geolocation still{.point = {0.5, -1, 300}, .time_s = 4, .covariance_enu_m2 = 2 * Eigen::Matrix3d::Identity()};
  still.ce90_m = 7;
  still.le90_m = 3;
  Geolocation moving = still;
  moving.velocity_enu = Eigen::Vector3d(1, 2, 3);
  moving.velocity_covariance_enu = Eigen::Matrix3d::Identity();
  const ObjectPlace unplaced{.inlier_fraction = 0.25};
  const ObjectPlace placed{.place = still, .heading_rad = 0.25, .inlier_fraction = 0.5, .size_ratio = 2};
  const ObjectPlace driving{
      .place = moving, .path_size = 300, .heading_rad = 6, .inlier_fraction = 1, .consistent_fraction = 0.5};
  const HypothesisFits fits{
      .relative = driving,
      .absolute = placed,
      .on_level = HypothesisFits::LevelFit{.level = {.altitude_m = 200, .sigma_m = 1.5},
                                           .place = {.relative = driving, .absolute = moving}},
      .tracklet = HypothesisFits::Tracklet{.summary = {.log_odds = 1.5, .recognitions = 2, .observations = 4},
                                           .frames = {0, 1, 500, 100'000}}};
  const FlightFits flight{.errors = {.heading = HeadingError{.error_rad = 0.1, .objects = 3},
                                     .range = RangeFactor{.factor = 1.2, .objects = 2}},
                          .overlaps = {{.first = 1, .second = 2, .frames = 30}}};
  const std::vector<Geolocation> path = {still, moving};
  return {"",
          ToText(Pack(HypothesisFits())),
          ToText(Pack(HypothesisFits{.relative = unplaced})),
          ToText(Pack(HypothesisFits{.absolute = placed})),
          ToText(Pack(fits)),
          ToText(Pack(FlightFits())),
          ToText(Pack(flight)),
          ToText(Pack(path))};
}
