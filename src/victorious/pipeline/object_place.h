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
  double borne_out = 0;               ///< the share that bears each other out: they meet there, turned alike
  std::optional<double> too_large;    ///< the factor by which the object seems too large for where its lines meet
};

/// All errors of the telemetry, those common to a flight in proportion `common_share`.
/// @param sights  of one object, one or more; in order of time
ObjectPlace PlaceOf(std::span<const Sight> sights, const ObjectOptions& options, double common_share);

/// Taken to another time by how it moves, and by how sure that is.
Place At(const Place& place, double time_s);

/// How many sigmas of both a sight is off from what is at a place: its line goes by it, and its range, where it tells
/// one, is another. Errors common to the sight's flight count in proportion `common_share`.
/// @param place    at the sight's time
/// @param slack_m  sigma beside, along each axis
/// @return infinity for what is behind the camera
double SigmasOff(const Sight& sight, const Place& place, double slack_m, const LocateOptions& errors,
                 double common_share);

/// The direction that most headings are near: the middle of the densest 40 degrees.
std::optional<double> CommonHeading(std::span<const double> headings_rad);

}  // namespace victorious
