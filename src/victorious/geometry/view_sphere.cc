#include "victorious/geometry/view_sphere.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

using Eigen::Vector3d;

// Index arithmetic of the grid: view 0 is the pole, then the rings follow.
struct Grid {
  int rings = 0;
  int views_per_ring = 0;

  [[nodiscard]] int Index(int ring, int place) const {
    return 1 + ring * views_per_ring + (place + views_per_ring) % views_per_ring;
  }

  [[nodiscard]] std::vector<int> FindNeighbours(int ring, int place) const {
    std::vector<int> neighbours;
    for (int r = std::max(ring - 1, 0); r <= std::min(ring + 1, rings - 1); ++r) {
      for (int p = place - 1; p <= place + 1; ++p) neighbours.push_back(Index(r, p));
    }
    if (ring == 0) neighbours.push_back(0);
    std::ranges::sort(neighbours);
    const auto doubled = std::ranges::unique(neighbours);  // duplicates occur in rings of one or two views
    neighbours.erase(doubled.begin(), doubled.end());
    std::erase(neighbours, Index(ring, place));
    return neighbours;
  }

  [[nodiscard]] std::vector<int> FindPoleNeighbours() const {
    std::vector<int> neighbours;
    for (int place = 0; rings > 0 && place < views_per_ring; ++place) neighbours.push_back(Index(0, place));
    return neighbours;
  }
};

constexpr double kTolerance = 1e-9;  // of numbers of views and of rings

ViewSphere MakeGrid(int rings, int views_per_ring, double step_deg) {
  const Grid grid{.rings = rings, .views_per_ring = views_per_ring};
  ViewSphere sphere;
  sphere.views.push_back({{}, grid.FindPoleNeighbours()});
  for (int ring = 0; ring < rings; ++ring) {
    for (int place = 0; place < views_per_ring; ++place) {
      const ViewDirection direction{.azimuth_rad = RadiansFromDegrees(place * step_deg),
                                    .off_nadir_rad = RadiansFromDegrees((ring + 1) * step_deg)};
      sphere.views.push_back({direction, grid.FindNeighbours(ring, place)});
    }
  }
  return sphere;
}

// The place of a view in rings of different sizes. The pole is ring 0.
struct RingPlace {
  int ring = 0;
  int place = 0;
  int views_in_ring = 1;
};

// Radius of the neighbourhood in the rings beside a view's, in steps: a little more than the diagonal of the grid,
// since the views of rings of different sizes are not in line.
constexpr double kNeighbourSteps = 1.5;

bool AreNeighbours(const RingPlace& a, const RingPlace& b, double angle_rad, double step_rad) {
  if (a.ring != b.ring) return std::abs(a.ring - b.ring) == 1 && angle_rad <= kNeighbourSteps * step_rad;
  const int apart = std::abs(a.place - b.place);
  return apart == 1 || apart == a.views_in_ring - 1;
}

ViewSphere MakeEven(int rings, double step_deg) {
  constexpr int kMinViewsInRing = 3;  // around the pole
  ViewSphere sphere;
  std::vector<RingPlace> places;
  std::vector<Vector3d> to_camera;
  const auto add = [&](const RingPlace& at) {
    const ViewDirection direction{.azimuth_rad = 2 * kPi * at.place / at.views_in_ring,
                                  .off_nadir_rad = RadiansFromDegrees(at.ring * step_deg)};
    sphere.views.push_back({direction, {}});
    places.push_back(at);
    to_camera.push_back(DirectionToCamera(direction));
  };
  add({});
  for (int ring = 1; ring <= rings; ++ring) {
    const double circumference_deg = 360.0 * std::sin(RadiansFromDegrees(ring * step_deg));
    const int count = std::max(static_cast<int>(std::ceil(circumference_deg / step_deg - kTolerance)), kMinViewsInRing);
    for (int place = 0; place < count; ++place) add({.ring = ring, .place = place, .views_in_ring = count});
  }
  // In this order each view's neighbours come ascending.
  const double step_rad = RadiansFromDegrees(step_deg);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size() && places[j].ring <= places[i].ring + 1; ++j) {
      if (!AreNeighbours(places[i], places[j], AngleBetween(to_camera[i], to_camera[j]), step_rad)) continue;
      sphere.views[i].neighbours.push_back(static_cast<int>(j));
      sphere.views[j].neighbours.push_back(static_cast<int>(i));
    }
  }
  return sphere;
}

}  // namespace

void ViewSphereOptions::ListFields(FieldList& fields) {
  fields.Add("step", step_deg,
             {.min = 1,
              .max = 90,
              .unit = "deg",
              .reason = "between views; features tolerate a change of view of about 10 degrees"});
  fields.Add("max_off_nadir", max_off_nadir_deg,
             {.min = 0,
              .max = 180,
              .unit = "deg",
              .reason = "maximum off-nadir angle of a view; an airborne camera hardly sees larger ones"});
  fields.Add("layout", layout, kViewLayoutTexts,
             {.reason = "views of a ring of equal off-nadir angle: grid, one each step of azimuth; even, one each step "
                        "along the ring, so that views are as dense near the nadir as elsewhere"});
}

Expected<ViewSphere> MakeViewSphere(const ViewSphereOptions& options) {
  VICTORIOUS_RETURN_IF_ERROR(ValidateOptions(options));
  const double below = options.max_off_nadir_deg < 180.0 ? options.max_off_nadir_deg : 180.0 - options.step_deg;
  const int rings = static_cast<int>(below / options.step_deg + kTolerance);
  if (options.layout == ViewLayout::kEven) return MakeEven(rings, options.step_deg);
  const double views_per_ring = 360.0 / options.step_deg;
  if (std::abs(views_per_ring - std::round(views_per_ring)) > kTolerance) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("step {} degrees: must divide 360 for the layout grid", options.step_deg));
  }
  return MakeGrid(rings, static_cast<int>(std::lround(views_per_ring)), options.step_deg);
}

Expected<PosedCamera> CameraForView(const ViewDirection& direction, const Sphere& sphere, const ViewFraming& framing) {
  if (!(sphere.radius > 0) || !(framing.distance_m > sphere.radius)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("distance {} m to the centre of an object of radius {} m: must be "
                            "more than its radius",
                            framing.distance_m, sphere.radius));
  }
  if (!(framing.diameter_px > 0) || framing.width_px < 1 || framing.height_px < 1) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("an object of {} px in an image of {} x {}: sizes must be above 0", framing.diameter_px,
                            framing.width_px, framing.height_px));
  }
  const double grazing = std::sqrt(framing.distance_m * framing.distance_m - sphere.radius * sphere.radius);
  const double focal_px = framing.diameter_px / 2 * grazing / sphere.radius;

  const Eigen::Quaterniond camera_from_model = CameraFromModel(direction);
  const Vector3d eye = sphere.centre + framing.distance_m * DirectionToCamera(direction);
  return PosedCamera{.pinhole = {.fx = focal_px,
                                 .fy = focal_px,
                                 .cx = framing.width_px / 2.0,
                                 .cy = framing.height_px / 2.0,
                                 .width = framing.width_px,
                                 .height = framing.height_px},
                     .camera_from_world = {camera_from_model, -(camera_from_model * eye)}};
}

}  // namespace victorious
