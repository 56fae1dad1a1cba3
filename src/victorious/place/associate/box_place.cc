#include "victorious/place/associate/box_place.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "victorious/place/associate/object_place.h"
#include "victorious/place/observe/box_bearing.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Window of places, before and after, for a velocity; and their minimum number, with two degrees of freedom for the
// scatter about the line. Chosen, not fitted.
constexpr double kWindow_s = 1;
constexpr std::size_t kMinPlaces = 4;

// Estimates the velocity by a least-squares line through the places within kWindow_s.
void EstimateVelocity(std::span<std::optional<Geolocation>> places, std::size_t i) {
  const TangentPlane plane(places[i]->point);
  std::vector<std::pair<double, Vector3d>> near;
  Vector3d middle = Vector3d::Zero();
  double middle_s = 0;
  const auto is_near =
      [&](const std::optional<Geolocation>& place) {  // false ends the scan: later ones are at least as far
        if (!place) return true;
        if (std::abs(place->time_s - places[i]->time_s) > kWindow_s) return false;
        near.emplace_back(place->time_s, plane.EnuFromGeodetic(place->point));
        middle_s += near.back().first;
        middle += near.back().second;
        return true;
      };
  std::size_t begin = i;
  while (begin > 0 && is_near(places[begin - 1])) --begin;
  std::size_t end = i;
  while (end < places.size() && is_near(places[end])) ++end;
  if (near.size() < kMinPlaces) return;
  const auto count = static_cast<double>(near.size());
  middle /= count;
  middle_s /= count;
  double spread_s2 = 0;
  Vector3d moved = Vector3d::Zero();
  for (const auto& [time_s, point] : near) {
    spread_s2 += (time_s - middle_s) * (time_s - middle_s);
    moved += (time_s - middle_s) * (point - middle);
  }
  if (!(spread_s2 > 0)) return;
  const Vector3d velocity = moved / spread_s2;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& [time_s, point] : near) {
    const Vector3d off = point - middle - (time_s - middle_s) * velocity;
    scatter += off * off.transpose();
  }
  places[i]->velocity_enu = velocity;
  places[i]->velocity_covariance_enu = scatter / ((count - 2) * spread_s2);
}

// The place, unless so few lines of sight are its inliers that the track has drifted to something else.
std::optional<Geolocation> AcceptedPlace(const ObjectPlace& found) {
  return found.inlier_fraction >= kMinBoxInlierFraction ? found.place : std::nullopt;
}

// Side of the box about a ground point: kBoxCentreFraction of it, 1 px, is the tracking error of the point.
constexpr double kPointBox_px = 8;

void SetGround(const ObjectGround& ground, ObjectOptions& object) {
  object.locate.ground_sigma_m = ground.sigma_m;
  object.ground = ground.ground;
}

// The ground constrains the distance better than the size prior of the type. Uses the ranges only if the lines of sight
// alone give no place.
ObjectPlace PlaceOnGround(std::span<const BearingObservation> observations, const ObjectOptions& object) {
  std::vector<BearingObservation> lines(observations.begin(), observations.end());
  for (BearingObservation& observation : lines) observation.line.range_m.reset();
  ObjectPlace found = EstimatePlace(lines, object, 1);
  return found.place ? found : EstimatePlace(observations, object, 1);
}

// One observation alone: at the intersection of its line of sight with the ground, or by its range.
std::optional<Geolocation> LocateSingle(const BearingObservation& observation, ObjectOptions object) {
  object.locate.motion = MotionModel::kStatic;
  return PlaceOnGround({&observation, 1}, object).place;
}

// Each observation alone, at the intersection of its line of sight with the ground.
std::vector<std::optional<Geolocation>> IntersectGround(std::span<const BearingObservation> observations,
                                                        const ObjectOptions& object) {
  std::vector<std::optional<Geolocation>> places;
  for (const BearingObservation& observation : observations) places.push_back(LocateSingle(observation, object));
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i]) EstimateVelocity(places, i);
  }
  return places;
}

}  // namespace

void BoxPlaceOptions::ListFields(FieldList& fields) {
  fields.Add(
      "max_interval_s", max_interval_s,
      {.min = 0.5,
       .max = 1e6,
       .unit = "s",
       .reason = "a moving object is placed in intervals of at most this length, with constant velocity in each"});
  fields.Add("gate_sigma", gate_sigma,
             {.min = 0.5,
              .max = 100,
              .reason = "a detection in another video is another object if the Mahalanobis distance of its line of "
                        "sight to the object's place exceeds this"});
  VideoLocateFields fields_of_locate{locate};
  fields.AddGroup("locate", fields_of_locate);
}

std::optional<Geolocation> LocateGroundPoint(std::span<const GroundPointObservation> ground_points,
                                             const CameraTrajectory& cameras, const cv::Size& image_size,
                                             const BoxPlaceOptions& options) {
  std::vector<BearingObservation> observations;
  for (const GroundPointObservation& ground_point : ground_points) {
    const std::optional<CameraState> camera = cameras.At(ground_point.time_s);
    if (!camera) continue;
    const Box about{ground_point.position_px.x() - kPointBox_px / 2, ground_point.position_px.y() - kPointBox_px / 2,
                    kPointBox_px, kPointBox_px};
    if (auto observation = MakeBoxBearingObservation(about, image_size, *camera, nullptr, 0))
      observations.push_back(*std::move(observation));
  }
  ObjectOptions object;
  object.locate = options.locate;
  object.locate.motion = MotionModel::kStatic;
  return AcceptedPlace(EstimatePlace(observations, object, 1));
}

ObjectGround ObjectGround::AtPlace(const Geolocation& place) {
  return {std::make_shared<const FlatGround>(place.point.altitude_m), std::sqrt(place.covariance_enu_m2(2, 2))};
}

std::vector<std::optional<Geolocation>> EstimateBoxPlaces(std::span<const BearingObservation> observations,
                                                          BoxMotion motion, const std::optional<ObjectGround>& ground,
                                                          const BoxPlaceOptions& options) {
  std::vector<std::optional<Geolocation>> places(observations.size());
  if (observations.empty()) return places;
  ObjectOptions object;
  object.locate = options.locate;
  object.motion_window_s = options.max_interval_s;
  if (ground) SetGround(*ground, object);
  if (motion == BoxMotion::kMoving && ground) return IntersectGround(observations, object);
  if (motion == BoxMotion::kStatic) object.locate.motion = MotionModel::kStatic;
  const ObjectPlace together = ground ? PlaceOnGround(observations, object) : EstimatePlace(observations, object, 1);
  const std::optional<Geolocation> all = AcceptedPlace(together);
  if (motion == BoxMotion::kUnknown && ground && !all) return IntersectGround(observations, object);
  if (motion != BoxMotion::kMoving && !(all && all->IsMoving())) {
    for (std::size_t i = 0; i < observations.size() && all; ++i)
      places[i] = PropagatePlace(*all, observations[i].line.time_s);
    return places;
  }
  const double first_s = observations.front().line.time_s;
  const double length_s = observations.back().line.time_s - first_s;
  const double stretches = std::max(1.0, std::ceil(length_s / options.max_interval_s));
  const auto stretch_of = [&](const BearingObservation& observation) {
    return length_s > 0
               ? std::min(stretches - 1, std::floor((observation.line.time_s - first_s) / length_s * stretches))
               : 0;
  };
  object.locate.motion = MotionModel::kVelocity;
  for (std::size_t first = 0; first < observations.size();) {
    std::size_t end = first;
    while (end < observations.size() && stretch_of(observations[end]) == stretch_of(observations[first])) ++end;
    const std::optional<Geolocation> place =
        AcceptedPlace(EstimatePlace(observations.subspan(first, end - first), object, 1));
    for (std::size_t i = first; i < end; ++i) {
      places[i] = place ? PropagatePlace(*place, observations[i].line.time_s) : LocateSingle(observations[i], object);
    }
    first = end;
  }
  return places;
}

bool IsConsistentWithPlace(const BearingObservation& observation, const Geolocation& place,
                           const BoxPlaceOptions& options) {
  BearingObservation line_alone = observation;
  line_alone.line.range_m.reset();
  // Errors common to a flight count in full: the place comes from another flight, with independent ones.
  return MahalanobisDistance(line_alone, place, 0, options.locate, 1) <= options.gate_sigma;
}

}  // namespace victorious
