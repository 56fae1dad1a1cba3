// Private to associate/: an object that several flights see.
//
// Within a flight, places are far more accurate than the errors that all its lines of sight share (position, attitude,
// clock, field of view), which are independent of those of other flights. There is therefore no joint fit of the lines
// of several flights: each flight gives its own place, or path, of the object. Two are one object's if they agree
// within the errors of both: those of the flights as telemetry states them, or the smaller ones that remain once all
// objects that both flights see have shown their offset (flight_registration.h). Objects that move are compared at the
// same time, by UTC.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "victorious/place/associate/fits.h"
#include "victorious/place/associate/object_hypothesis.h"
#include "victorious/place/associate/object_place.h"

namespace victorious {

/// What one flight says of an object.
struct ObjectInFlight {
  std::int64_t id = 0;  ///< ObjectId of its hypothesis
  std::int64_t video = 0;
  std::int64_t model = 0;
  bool is_category = false;
  ObjectPlace relative;  ///< for comparisons within the flight, with its path, if it has one; has a place
  Geolocation absolute;  ///< at the same time, with all errors of the flight
  /// Covariance of the errors that all places of the flight share: see SetPlaces().
  Eigen::Matrix3d common_m2 = Eigen::Matrix3d::Zero();
  std::optional<double> utc_offset_s;  ///< UTC minus the video's time, since an epoch that all flights share
  double first_s = 0;                  ///< of its sightings, UTC, or the video's time without it
  double last_s = 0;
  double observations = 0;                             ///< number of its bearing observations
  std::span<const ObservedTracklet* const> tracklets;  ///< of its hypothesis, which must outlive it

  [[nodiscard]] bool IsMoving() const { return relative.IsMoving(); }

  /// Sets `relative`, `absolute` and `common_m2`.
  void SetPlaces(ObjectPlace within_flight, const Geolocation& with_all_errors);
};

/// The object of a hypothesis of one flight. std::nullopt if it has no place. The path is missing.
[[nodiscard]] std::optional<ObjectInFlight> MakeObjectInFlight(ObjectHypothesis& of_one_flight, Fits& fits);

/// The place by a second flight minus the place by a first one.
struct FlightOffset {
  Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

/// What two flights say of one object, from the place by the first to that by the second.
struct PlaceDifference {
  /// In the middle of the time in which both see it, or in the middle between, if one ends before the other begins.
  /// Its covariance contains the errors of the places within their flights.
  FlightOffset offset;
  Eigen::Matrix3d flights_m2 = Eigen::Matrix3d::Zero();  ///< covariance of the errors of both flights
  double change_sigmas = 0;                              ///< Mahalanobis distance of its change over that time
};

/// An object that one flight has lost may be seen by another so much later, s: beyond, its path says too little.
inline constexpr double kMaxFlightGap_s = 2;

/// Compares what may be one object.
/// @param moves  then both are compared at one time: std::nullopt if a video has no UTC, or more than kMaxFlightGap_s
///               are between them
[[nodiscard]] std::optional<PlaceDifference> CompareFlights(const ObjectInFlight& a, const ObjectInFlight& b,
                                                            bool moves);

[[nodiscard]] bool IsAnyMoving(std::span<const ObjectInFlight* const> flights);

/// The place of FuseFlights() of an object that stands; ce90_m and le90_m are not its.
/// @param flights  at least one
[[nodiscard]] Geolocation FuseStatic(std::span<const ObjectInFlight* const> flights);

/// The place by all flights, at the time of the last sighting, on the clock of the video that has it; without a path.
/// If the object stands, the places are averaged, weighted by their information. If it moves, its place is that of the
/// flight that sees it last; each other flight corrects the common error of that one by a Kalman update.
/// @param flights  at least one
[[nodiscard]] ObjectPlace FuseFlights(std::span<const ObjectInFlight* const> flights);

}  // namespace victorious
