// Which objects or sightings of an index are meant.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "victorious/base/enum_text.h"
#include "victorious/geometry/geodesy.h"

namespace victorious {

/// A circle around a point of the Earth; heights are ignored.
struct GeoCircle {
  GeodeticPoint centre;
  double radius_m = 0;
};

/// A region between parallels and meridians, radians; it does not cross the antimeridian.
struct GeoBox {
  double south_rad = 0;
  double west_rad = 0;
  double north_rad = 0;
  double east_rad = 0;
};

/// Whether the thresholds of models (threshold_store.h) leave out objects that nobody has decided and that score less.
enum class ThresholdUse { kIgnored, kApplied };

/// The texts of the command line and of the API.
inline constexpr auto kThresholdUseTexts =
    std::to_array<EnumText<ThresholdUse>>({{ThresholdUse::kApplied, "applied"}, {ThresholdUse::kIgnored, "ignored"}});

/// An object of a model that scores less is more likely false than right: a weak find. Scores are probabilities.
/// Categories have no such bound: their scores are those of single frames.
inline constexpr double kWeakScore = 0.5;

/// Selects objects or sightings. All conditions that are set must hold.
struct SightingFilter {
  std::optional<std::string> model_name;
  std::optional<std::string> category_name;  ///< includes subcategories: "vehicle" matches "vehicle/car"
  std::optional<std::string> video_name;     ///< see FindVideosByName
  std::optional<double> from_s;          ///< inclusive; an object matches if its time interval overlaps [from_s, to_s]
  std::optional<double> to_s;            ///< inclusive
  std::optional<GeoCircle> near;         ///< only objects of known place, and their sightings
  bool include_rejected = false;         ///< include rejected objects
  std::optional<std::int64_t> object;    ///< the object of this id
  std::optional<std::int64_t> video;     ///< the video of this id, or objects seen in it
  std::optional<std::int64_t> tracklet;  ///< the tracklet of this id, or its object
  ThresholdUse thresholds = ThresholdUse::kIgnored;  ///< kApplied: those in force
  bool without_weak = false;  ///< without weak finds that nobody has decided, but for rejected objects
};

}  // namespace victorious
