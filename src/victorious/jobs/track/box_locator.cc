#include "victorious/jobs/track/box_locator.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "victorious/place/observe/object_type.h"

namespace victorious {
namespace {

/// True if objects of the type need not be on the ground. @param type  or null
bool CanFly(const ObjectType* type) { return type != nullptr && type->can_fly; }

}  // namespace

void BoxLocator::Locate(std::vector<BoxSighting>& sightings) const {
  std::ranges::sort(sightings, {},
                    [](const BoxSighting& one) { return std::tuple(one.video, one.frame, one.box_index); });
  for (std::size_t box_index = 0; box_index < boxes_.size(); ++box_index) {
    const ObjectType* type = FindObjectType(boxes_[box_index].type);
    const SeenByVideo seen = Observe(box_index, sightings);
    const BoxMotion motion = ClassifyMotion(box_index, seen[0]);
    // The ground point constrains the place only if the object is on the ground: a type that does not fly, or an
    // untyped object that leaves its ground point.
    const std::optional<ObjectGround> given = GivenGround(box_index);
    const bool on_ground_point = type != nullptr ? !CanFly(type) : motion == BoxMotion::kMoving;
    const std::optional<ObjectGround> ground = given || !on_ground_point ? given : EstimateGround(box_index);
    SetPlaces(seen[0], motion, ground);
    const bool stands = motion != BoxMotion::kMoving && !seen[0].empty() && seen[0].front()->place &&
                        !seen[0].front()->place->IsMoving();
    std::vector<BoxSighting*> all;
    for (const auto& of_video : seen) all.insert(all.end(), of_video.begin(), of_video.end());
    if (stands && all.size() > seen[0].size()) SetPlaces(all, BoxMotion::kStatic, ground);
    for (std::size_t video = 1; video < seen.size() && !stands; ++video) SetPlaces(seen[video], motion, given);
  }
}

// Sets the bearing observations of an object's sightings. Returns those that have one, by video.
BoxLocator::SeenByVideo BoxLocator::Observe(std::size_t box_index, std::vector<BoxSighting>& sightings) const {
  const ObjectType* type = FindObjectType(boxes_[box_index].type);
  SeenByVideo seen(videos_.sizes.size());
  for (BoxSighting& sighting : sightings) {
    if (sighting.box_index != box_index) continue;
    const auto camera = CameraAt(sighting);
    if (!camera) continue;
    const auto recognition = static_cast<std::int64_t>(sighting.video * boxes_.size() + box_index + 1);
    sighting.observation =
        MakeBoxBearingObservation(sighting.extent, videos_.sizes[sighting.video], *camera, type, recognition);
    if (sighting.observation) seen[sighting.video].push_back(&sighting);
  }
  return seen;
}

// Classifies the motion by the largest distance of the box from the ground point on which it was drawn, over the box's
// longer side. Tall objects and box jitter cause small distances also for static objects.
BoxMotion BoxLocator::ClassifyMotion(std::size_t box_index, const std::vector<BoxSighting*>& seen) const {
  const ObjectType* type = FindObjectType(boxes_[box_index].type);
  if (type != nullptr && type->is_static) return BoxMotion::kStatic;
  constexpr double kMoving = 1;
  constexpr double kStaticDistance = 0.5;
  constexpr double kMaxOutlierFraction = 0.05;  // fraction of outlier boxes ignored, at least three
  std::vector<double> away;
  for (const BoxSighting* sighting : seen) {
    const auto ground_point = ground_points_[box_index].find(sighting->frame);
    if (ground_point == ground_points_[box_index].end() || TouchesImageBorder(sighting->box, videos_.sizes[0]))
      continue;
    const Box& box = sighting->extent;
    const Eigen::Vector2d centre(box.x + box.width / 2, box.y + box.height / 2);
    away.push_back((centre - ground_point->second.position_px).norm() / std::max(box.width, box.height));
  }
  const std::size_t outliers =
      std::max<std::size_t>(3, static_cast<std::size_t>(kMaxOutlierFraction * std::ssize(away)));
  if (away.size() <= outliers) return BoxMotion::kUnknown;
  std::ranges::nth_element(away, away.end() - 1 - static_cast<std::ptrdiff_t>(outliers));
  const double farthest = *(away.end() - 1 - static_cast<std::ptrdiff_t>(outliers));
  if (farthest > kMoving) return BoxMotion::kMoving;
  return farthest < kStaticDistance && 2 * away.size() > seen.size() ? BoxMotion::kStatic : BoxMotion::kUnknown;
}

std::optional<CameraState> BoxLocator::CameraAt(const BoxSighting& sighting) const {
  return videos_.cameras[sighting.video].At(sighting.time_s);
}

// The given ground; std::nullopt if there is none, or if the object may fly.
std::optional<ObjectGround> BoxLocator::GivenGround(std::size_t box_index) const {
  if (!given_ground_ || CanFly(FindObjectType(boxes_[box_index].type))) return std::nullopt;
  return ObjectGround{given_ground_, options_.locate.ground_sigma_m};
}

// Ground at the ground point on which the box was drawn.
std::optional<ObjectGround> BoxLocator::EstimateGround(std::size_t box_index) const {
  if (!videos_.cameras[0].HasStates()) return std::nullopt;
  std::vector<GroundPointObservation> ground_points;
  for (const auto& [frame, ground_point] : ground_points_[box_index]) ground_points.push_back(ground_point);
  const std::optional<Geolocation> place =
      LocateGroundPoint(ground_points, *videos_.cameras[0].trajectory(), videos_.sizes[0], options_);
  return place ? std::optional(ObjectGround::AtPlace(*place)) : std::nullopt;
}

void BoxLocator::WarnOfGround(std::span<const BoxSighting> sightings, const WarningSink& warn) const {
  if (!given_ground_) return;
  constexpr double kFarSigmas = 3;
  for (std::size_t box_index = 0; box_index < boxes_.size(); ++box_index) {
    if (CanFly(FindObjectType(boxes_[box_index].type))) continue;
    const auto seen = std::ranges::find_if(
        sightings, [&](const BoxSighting& one) { return one.box_index == box_index && one.place.has_value(); });
    if (seen == sightings.end()) continue;
    const GeodeticPoint& point = seen->place->point;
    const std::optional<double> ground_m = given_ground_->HeightAt(point);
    const double sigma_m = std::sqrt(seen->place->covariance_enu_m2(2, 2)) + options_.locate.ground_sigma_m;
    if (!ground_m || std::abs(point.altitude_m - *ground_m) <= kFarSigmas * sigma_m) continue;
    warn(
        fmt::format("{}: its lines of sight intersect at {:.1f} m, but the given ground is at {:.1f} m there: the "
                    "ground is ignored",
                    BoxName(box_index), point.altitude_m, *ground_m));
  }
}

std::string BoxLocator::DescribePlaceFailure(std::size_t box_index, std::span<const BoxSighting> sightings) const {
  const auto of_it = [&](const BoxSighting& one) { return one.box_index == box_index; };
  const auto any = [&](const auto& what) {
    return std::ranges::any_of(sightings, [&](const BoxSighting& one) { return of_it(one) && what(one); });
  };
  if (any([](const BoxSighting& one) { return one.place.has_value(); })) return "";
  if (any([](const BoxSighting& one) { return one.observation.has_value(); })) {
    return given_ground_ ? "its lines of sight do not determine its distance, and do not meet the given ground"
                         : "its lines of sight do not determine its distance: give --ground METRES, --terrain FILE or "
                           "--type WORD";
  }
  if (std::ranges::none_of(videos_.cameras, &CameraStates::HasStates)) {
    if (std::ranges::any_of(videos_.cameras, &CameraStates::is_forgotten))
      return "telemetry contradicts the image, and is not used";
    return "no telemetry with camera position, attitude and field of view: give --telemetry FILE; `victorious doctor "
           "VIDEO` reports what is missing";
  }
  if (any([&](const BoxSighting& one) { return CameraAt(one).has_value(); })) {
    return "telemetry lacks camera position, attitude or field of view while the object is visible; `victorious "
           "doctor VIDEO` reports what is missing";
  }
  const auto first = std::ranges::find_if(sightings, of_it);
  const auto last = std::ranges::find_if(sightings.rbegin(), sightings.rend(), of_it);
  return fmt::format("telemetry has no state from {:.2f} to {:.2f} s, while the object is visible", first->time_s,
                     last->time_s);
}

void BoxLocator::SetPlaces(const std::vector<BoxSighting*>& seen, BoxMotion motion,
                           const std::optional<ObjectGround>& ground) const {
  std::vector<BearingObservation> observations;
  for (const BoxSighting* sighting : seen) observations.push_back(*sighting->observation);
  // The times of photos are invented: no motion follows from them.
  if (!seen.empty() && videos_.cameras[seen.front()->video].is_of_photos()) motion = BoxMotion::kStatic;
  const auto places = EstimateBoxPlaces(observations, motion, ground, options_);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i]->place = places[i];
}

std::vector<std::optional<StaticBox>> BoxLocator::FindStaticBoxes(std::span<const UserBoxTarget> targets,
                                                                  std::span<const BoxSighting> sightings) const {
  std::vector<std::optional<StaticBox>> standing(boxes_.size());
  for (const UserBoxTarget& target : targets) {
    const auto seen = std::ranges::find_if(sightings, [&](const BoxSighting& one) {
      return one.video == 0 && one.box_index == target.box_index && one.frame == target.frame;
    });
    if (seen == sightings.end() || !seen->place || seen->place->IsMoving()) continue;
    standing[target.box_index] = {*seen->place, target.box, *CameraAt(*seen)};
  }
  return standing;
}

}  // namespace victorious
