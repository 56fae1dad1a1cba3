// Private to associate/: the bytes of a kept fit. Little-endian; read by the program that wrote them only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/flight_errors.h"
#include "victorious/place/associate/object_place.h"
#include "victorious/place/associate/object_rejection.h"
#include "victorious/place/associate/observed_tracklet.h"

namespace victorious {

/// What is kept of the fits of one set of tracklets. Places are without their paths.
struct HypothesisFits {
  std::optional<ObjectPlace> relative;
  std::optional<ObjectPlace> absolute;
  struct LevelFit {
    Level level;
    LevelPlace place;
  };
  std::optional<LevelFit> on_level;

  /// Of a single tracklet.
  struct Tracklet {
    TrackletSummary summary;
    std::vector<std::int64_t> frames;
  };
  std::optional<Tracklet> tracklet;
};

/// What is kept of a flight.
struct FlightFits {
  FlightErrors errors;
  std::vector<TrackletOverlap> overlaps;
};

[[nodiscard]] std::vector<std::byte> Pack(const HypothesisFits& fits);
[[nodiscard]] std::vector<std::byte> Pack(const FlightFits& fits);
[[nodiscard]] std::vector<std::byte> Pack(std::span<const Geolocation> path);

/// std::nullopt for bytes that Pack did not make.
[[nodiscard]] std::optional<HypothesisFits> UnpackHypothesisFits(std::span<const std::byte> bytes);
[[nodiscard]] std::optional<FlightFits> UnpackFlightFits(std::span<const std::byte> bytes);
[[nodiscard]] std::optional<std::vector<Geolocation>> UnpackPath(std::span<const std::byte> bytes);

}  // namespace victorious
