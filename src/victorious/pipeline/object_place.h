// Where the object is that some sights show, and how it is turned.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "victorious/geolocate/locate.h"
#include "victorious/pipeline/object_options.h"
#include "victorious/types/sight.h"

namespace victorious {

struct ObjectPlace {
  std::optional<Place> place;
  std::optional<double> heading_rad;  ///< clockwise from north
  double agreeing = 0;                ///< the share of sights whose lines meet at the place
  std::optional<double> too_large;    ///< the factor by which the object seems too large for where its lines meet
};

/// All errors of the telemetry, those common to a flight in proportion `common_share`.
/// @param sights  of one object, one or more; in order of time
ObjectPlace PlaceOf(std::span<const Sight> sights, const ObjectOptions& options, double common_share);

/// The direction that most headings are near: the middle of the densest 40 degrees.
std::optional<double> CommonHeading(std::span<const double> headings_rad);

}  // namespace victorious
