#include "victorious/associate/box_place.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/lens.h"
#include "victorious/associate/object_place.h"
#include "victorious/observe/bearing_observation.h"
#include "victorious/observe/object_pose.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Image point of a 3D point, px, and its ground sampling distance.
struct Projection {
  Vector2d pixel;
  double m_per_px = 0;
};

std::optional<Projection> Project(const GeodeticPoint& point, const CameraState& camera, const cv::Size& image) {
  const Vector3d in_camera = CameraFromEnu(*camera.attitude) * TangentPlane(camera.place).EnuFromGeodetic(point);
  if (!(in_camera.z() > 0)) return std::nullopt;
  const double focal_px = FocalLengthPx(*camera.hfov_rad, image.width);
  const Vector2d shown = Distort(in_camera.hnormalized(), camera.distortion.value_or(LensDistortion{}));
  return Projection{focal_px * shown + Vector2d(image.width / 2.0, image.height / 2.0), in_camera.z() / focal_px};
}

// Estimates the velocity by a least-squares line through the places within 1 s.
void TellVelocity(std::span<std::optional<Place>> places, std::size_t i) {
  constexpr double kWindow_s = 1;
  constexpr std::size_t kFewest = 4;
  const TangentPlane plane(places[i]->point);
  std::vector<std::pair<double, Vector3d>> near;
  Vector3d middle = Vector3d::Zero();
  double middle_s = 0;
  const auto is_near = [&](const std::optional<Place>& place) {  // false ends the scan: later ones are at least as far
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
  if (near.size() < kFewest) return;
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

void TellGround(const BoxGround& ground, ObjectOptions& object) {
  object.locate.ground_sigma_m = ground.sigma_m;
  object.ground = ground.ground;
}

// The ground constrains the distance better than the size prior of the type. Uses the ranges only if the lines of sight
// alone give no place.
ObjectPlace PlaceOnGround(std::span<const Sight> sights, const ObjectOptions& object) {
  std::vector<Sight> lines(sights.begin(), sights.end());
  for (Sight& sight : lines) sight.line.range_m.reset();
  ObjectPlace found = PlaceOf(lines, object, 1);
  return found.place ? found : PlaceOf(sights, object, 1);
}

// One observation alone: at the intersection of its line of sight with the ground, or by its range.
std::optional<Place> Alone(const Sight& sight, ObjectOptions object) {
  object.locate.motion = "static";
  return PlaceOnGround({&sight, 1}, object).place;
}

// Each observation alone, at the intersection of its line of sight with the ground.
std::vector<std::optional<Place>> OnGround(std::span<const Sight> sights, const ObjectOptions& object) {
  std::vector<std::optional<Place>> places;
  for (const Sight& sight : sights) places.push_back(Alone(sight, object));
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i]) TellVelocity(places, i);
  }
  return places;
}

}  // namespace

void BoxPlaceOptions::ListFields(FieldList& fields) {
  fields.Add("centre_share", centre_share,
             {.min = 0,
              .max = 1,
              .reason = "standard deviation of an object's centre over the longer side of its box: how the box was "
                        "drawn, and background within it"});
  fields.Add("visible_share", visible_share,
             {.min = 0.05,
              .max = 2,
              .reason = "ratio of the longer side of a box to that of its object, because of foreshortening"});
  fields.Add("size_share", size_share, {.min = 1e-3, .max = 10, .reason = "relative standard deviation of that ratio"});
  fields.Add("least_agreeing", least_agreeing,
             {.min = 0,
              .max = 1,
              .reason = "fraction of the lines of sight that must be inliers of a place; if fewer are, the track has "
                        "drifted to something else"});
  fields.Add(
      "stretch_s", stretch_s,
      {.min = 0.5,
       .max = 1e6,
       .unit = "s",
       .reason = "a moving object is placed in intervals of at most this length, with constant velocity in each"});
  fields.Add("gate_sigma", gate_sigma,
             {.min = 0.5,
              .max = 100,
              .reason = "a detection in another video is another object if the Mahalanobis distance of its line of "
                        "sight to the object's place exceeds this"});
  fields.AddGroup("locate", locate);
}

bool EndsAtTheEdge(const Box& box, const cv::Size& image) {
  constexpr double kMarginPx = 1;
  return box.x < kMarginPx || box.y < kMarginPx || box.x + box.width > image.width - kMarginPx ||
         box.y + box.height > image.height - kMarginPx;
}

std::optional<Sight> SightOfBox(const Box& box, const cv::Size& image_size, const CameraState& camera,
                                const ObjectType* type, std::int64_t recognition, const BoxPlaceOptions& options) {
  SightOptions sight_options;
  sight_options.category_centre_share = options.centre_share;
  auto stance = StanceOfBox(box, image_size, camera, sight_options);
  if (!stance) return std::nullopt;
  if (type != nullptr && type->length_m > 0 && !EndsAtTheEdge(box, image_size)) {
    const double side_px = std::max(box.width, box.height);
    stance->range_m = stance->focal_px * options.visible_share * type->length_m / side_px;
    stance->sigma_range_m = std::hypot(options.size_share, type->length_share) * *stance->range_m;
  }
  std::optional<Sight> sight = SightOf(*stance, camera);
  if (sight) sight->recognition = recognition;
  return sight;
}

std::optional<Place> PlaceOfSpot(std::span<const SpotSighting> spots, const CameraTrack& cameras,
                                 const cv::Size& image_size, const BoxPlaceOptions& options) {
  constexpr double kFollowed_px = 8;  // box size; centre_share of it is the tracking error of the point
  std::vector<Sight> sights;
  for (const SpotSighting& spot : spots) {
    const std::optional<CameraState> camera = cameras.At(spot.time_s);
    if (!camera) continue;
    const Box about{spot.place.x() - kFollowed_px / 2, spot.place.y() - kFollowed_px / 2, kFollowed_px, kFollowed_px};
    if (auto sight = SightOfBox(about, image_size, *camera, nullptr, 0, options)) sights.push_back(*std::move(sight));
  }
  ObjectOptions object;
  object.locate = options.locate;
  object.locate.motion = "static";
  const ObjectPlace found = PlaceOf(sights, object, 1);
  return found.agreeing >= options.least_agreeing ? found.place : std::nullopt;
}

BoxGround BoxGround::About(const Place& place) {
  return {std::make_shared<const FlatGround>(place.point.altitude_m), std::sqrt(place.covariance_enu_m2(2, 2))};
}

std::vector<std::optional<Place>> PlacesOf(std::span<const Sight> sights, BoxMotion motion,
                                           const std::optional<BoxGround>& ground, const BoxPlaceOptions& options) {
  std::vector<std::optional<Place>> places(sights.size());
  if (sights.empty()) return places;
  ObjectOptions object;
  object.locate = options.locate;
  object.motion_window_s = options.stretch_s;
  if (ground) TellGround(*ground, object);
  if (motion == BoxMotion::kMoves && ground) return OnGround(sights, object);
  if (motion == BoxMotion::kStands) object.locate.motion = "static";
  const ObjectPlace together = ground ? PlaceOnGround(sights, object) : PlaceOf(sights, object, 1);
  const std::optional<Place> all = together.agreeing >= options.least_agreeing ? together.place : std::nullopt;
  if (motion == BoxMotion::kUnknown && ground && !all) return OnGround(sights, object);
  if (motion != BoxMotion::kMoves && !(all && all->Moves())) {
    for (std::size_t i = 0; i < sights.size() && all; ++i) places[i] = At(*all, sights[i].line.time_s);
    return places;
  }
  const double first_s = sights.front().line.time_s;
  const double length_s = sights.back().line.time_s - first_s;
  const double stretches = std::max(1.0, std::ceil(length_s / options.stretch_s));
  const auto stretch_of = [&](const Sight& sight) {
    return length_s > 0 ? std::min(stretches - 1, std::floor((sight.line.time_s - first_s) / length_s * stretches)) : 0;
  };
  object.locate.motion = "velocity";
  for (std::size_t first = 0; first < sights.size();) {
    std::size_t end = first;
    while (end < sights.size() && stretch_of(sights[end]) == stretch_of(sights[first])) ++end;
    const ObjectPlace found = PlaceOf(sights.subspan(first, end - first), object, 1);
    const std::optional<Place> place = found.agreeing >= options.least_agreeing ? found.place : std::nullopt;
    for (std::size_t i = first; i < end; ++i) {
      places[i] = place ? At(*place, sights[i].line.time_s) : Alone(sights[i], object);
    }
    first = end;
  }
  return places;
}

std::optional<SeenBox> ExpectBox(const GeodeticPoint& place, const Box& before, const CameraState& camera_before,
                                 const CameraState& camera, const cv::Size& image_size) {
  if (!camera_before.IsComplete() || !camera.IsComplete()) return std::nullopt;
  constexpr double kNorthM = 1;
  const GeodeticPoint north = TangentPlane(place).GeodeticFromEnu({0, kNorthM, 0});
  const auto was = Project(place, camera_before, image_size);
  const auto was_north = Project(north, camera_before, image_size);
  const auto is = Project(place, camera, image_size);
  const auto is_north = Project(north, camera, image_size);
  if (!was || !was_north || !is || !is_north) return std::nullopt;
  const double scale = was->m_per_px / is->m_per_px;
  const Vector2d from = was_north->pixel - was->pixel;
  const Vector2d to = is_north->pixel - is->pixel;
  const double width = scale * before.width;
  const double height = scale * before.height;
  return SeenBox{{is->pixel.x() - width / 2, is->pixel.y() - height / 2, width, height},
                 WrapAngle(std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()))};
}

bool GoesBy(const Sight& sight, const Place& place, const BoxPlaceOptions& options) {
  Sight line_alone = sight;
  line_alone.line.range_m.reset();
  // Errors common to a flight count in full: the place comes from another flight, with independent ones.
  return SigmasOff(line_alone, place, 0, options.locate, 1) <= options.gate_sigma;
}

}  // namespace victorious
