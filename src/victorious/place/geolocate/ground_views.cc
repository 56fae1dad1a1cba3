#include "victorious/place/geolocate/ground_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "victorious/geometry/attitude.h"
#include "victorious/geometry/camera.h"
#include "victorious/geometry/lens.h"
#include "victorious/geometry/polygon.h"

namespace victorious {
namespace {

constexpr double kMaxDistance_m = 20'000;
constexpr double kMaxCells = 4e6;

// A frame's camera in the tangent plane at its place.
class PosedFrame {
 public:
  explicit PosedFrame(const GroundLook& look)
      : look_(look),
        plane_(look.camera.place),
        camera_from_enu_(CameraFromEnu(*look.camera.attitude)),
        pinhole_(CentredPinhole(*look.camera.hfov_rad, look.width_px, look.height_px)) {}

  [[nodiscard]] std::optional<GeodeticPoint> GroundAt(const Eigen::Vector2d& pixel) const {
    Eigen::Vector3d ray = pinhole_.Unproject(pixel);
    if (look_.camera.distortion) ray.head<2>() = Undistort(ray.head<2>(), *look_.camera.distortion);
    const Eigen::Vector3d along = (camera_from_enu_.inverse() * ray).normalized();
    const auto patch = IntersectGround(*look_.ground, plane_, Eigen::Vector3d::Zero(), along, 0);
    if (!patch || patch->point.norm() > kMaxDistance_m) return std::nullopt;
    return plane_.GeodeticFromEnu(patch->point);
  }

  // std::nullopt: the frame does not show the point.
  [[nodiscard]] std::optional<PlaceView> ViewOf(const GeodeticPoint& point) const {
    const Eigen::Vector3d in_plane = plane_.EnuFromGeodetic(point);
    const double range_m = in_plane.norm();
    const Eigen::Vector3d in_camera = camera_from_enu_ * in_plane;
    if (!(in_camera.z() > 0) || range_m > kMaxDistance_m) return std::nullopt;
    const auto ideal = pinhole_.Project(in_camera);
    if (!ideal || !IsNear(*ideal)) return std::nullopt;  // far outside, a distortion may turn back into the image
    Eigen::Vector2d pixel = *ideal;
    if (look_.camera.distortion) {
      const Eigen::Vector2d bent = Distort(in_camera.head<2>() / in_camera.z(), *look_.camera.distortion);
      pixel = {bent.x() * pinhole_.fx + pinhole_.cx, bent.y() * pinhole_.fy + pinhole_.cy};
    }
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= pinhole_.width || pixel.y() >= pinhole_.height) {
      return std::nullopt;
    }
    if (look_.ground->MaxSlope() > 0 && IsHidden(in_plane, range_m)) return std::nullopt;
    const Eigen::Vector3d to_camera = plane_.LocalEnuFromEnu(in_plane) * (-in_plane / range_m);
    const double border_px = std::min({pixel.x(), pixel.y(), pinhole_.width - pixel.x(), pinhole_.height - pixel.y()});
    return PlaceView{.to_camera = to_camera.cast<float>(),
                     .px_per_m = static_cast<float>(pinhole_.fx / range_m),
                     .border_px = static_cast<float>(border_px)};
  }

 private:
  [[nodiscard]] bool IsNear(const Eigen::Vector2d& pixel) const {
    return std::abs(pixel.x() - pinhole_.cx) < pinhole_.width && std::abs(pixel.y() - pinhole_.cy) < pinhole_.height;
  }

  [[nodiscard]] bool IsHidden(const Eigen::Vector3d& in_plane, double range_m) const {
    const auto patch = IntersectGround(*look_.ground, plane_, Eigen::Vector3d::Zero(), in_plane / range_m, 0);
    return patch && patch->point.norm() < range_m - std::max(2 * look_.ground->Spacing(), 0.01 * range_m);
  }

  const GroundLook& look_;
  TangentPlane plane_;
  Eigen::Quaterniond camera_from_enu_;
  PinholeCamera pinhole_;
};

// A box between parallels and meridians; longitudes near the first point's, so that none jumps at the antimeridian.
struct Bounds {
  double south_rad = 0;
  double west_rad = 0;
  double north_rad = 0;
  double east_rad = 0;

  static Bounds Of(const std::vector<Eigen::Vector2d>& points) {
    Bounds bounds{points[0].y(), points[0].x(), points[0].y(), points[0].x()};
    for (const Eigen::Vector2d& point : points) {
      bounds = {std::min(bounds.south_rad, point.y()), std::min(bounds.west_rad, point.x()),
                std::max(bounds.north_rad, point.y()), std::max(bounds.east_rad, point.x())};
    }
    return bounds;
  }
};

// Longitude and latitude, rad.
std::vector<Eigen::Vector2d> FlatOutline(const std::vector<GeodeticPoint>& outline, double near_longitude_rad) {
  std::vector<Eigen::Vector2d> points;
  for (const GeodeticPoint& point : outline) {
    const double turn = std::remainder(point.longitude_rad - near_longitude_rad, 2 * std::numbers::pi);
    points.emplace_back(near_longitude_rad + turn, point.latitude_rad);
  }
  return points;
}

// A circle, by its corners.
std::vector<GeodeticPoint> CircleOutline(const GeodeticPoint& centre, double radius_m) {
  constexpr int kCorners = 64;
  const TangentPlane plane(centre);
  std::vector<GeodeticPoint> corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    corners.push_back(plane.GeodeticFromEnu({radius_m * std::cos(angle), radius_m * std::sin(angle), 0}));
  }
  return corners;
}

// Metres of a radian along the meridian and along the parallel.
Eigen::Vector2d MetresOfRadian(double latitude_rad) {
  constexpr double kStep_rad = 1e-6;
  const TangentPlane plane({latitude_rad, 0, 0});
  return {plane.EnuFromGeodetic({latitude_rad, kStep_rad, 0}).x() / kStep_rad,
          plane.EnuFromGeodetic({latitude_rad + kStep_rad, 0, 0}).y() / kStep_rad};
}

bool IsInConvex(const Polygon& hull, const Eigen::Vector2d& point) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d side = hull[(i + 1) % hull.size()] - hull[i];
    const Eigen::Vector2d to = point - hull[i];
    if (side.x() * to.y() - side.y() * to.x() < 0) return false;
  }
  return hull.size() > 2;
}

Expected<GroundCoverage> MakeGrid(const Polygon& area, const GridRequest& request) {
  const Bounds bounds = Bounds::Of(area);
  const Eigen::Vector2d metres = MetresOfRadian((bounds.south_rad + bounds.north_rad) / 2);
  const double width_m = (bounds.east_rad - bounds.west_rad) * metres.x();
  const double height_m = (bounds.north_rad - bounds.south_rad) * metres.y();
  const double cell_m =
      request.cell_m.value_or(std::max(request.min_cell_m, std::sqrt(width_m * height_m / request.max_cells)));
  const double columns = std::max(1.0, std::ceil(width_m / cell_m));
  const double rows = std::max(1.0, std::ceil(height_m / cell_m));
  if (columns * rows > kMaxCells) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("coverage: the area of {:.0f} x {:.0f} m has more than {:.0f} cells of {} m: give a larger "
                            "cell_m, or none",
                            width_m, height_m, kMaxCells, cell_m));
  }
  GroundCoverage grid{.north_rad = bounds.north_rad,
                      .west_rad = bounds.west_rad,
                      .row_rad = cell_m / metres.y(),
                      .column_rad = cell_m / metres.x(),
                      .cell_m = cell_m,
                      .columns = static_cast<int>(columns),
                      .rows = static_cast<int>(rows),
                      .in_area = {},
                      .looks = {},
                      .views = {},
                      .off_nadir_rad = {}};
  grid.in_area.reserve(grid.CellCount());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d middle(grid.west_rad + (column + 0.5) * grid.column_rad,
                                   grid.north_rad - (row + 0.5) * grid.row_rad);
      grid.in_area.push_back(IsInConvex(area, middle) ? 1 : 0);
    }
  }
  return grid;
}

// The first and the last cell, inclusive, that an interval of a grid's axis touches.
std::pair<int, int> CellsOf(double from, double to, double step, int count) {
  const auto clamped = [&](double at) {
    return static_cast<int>(std::clamp(std::floor(at / step), -1.0, double(count)));
  };
  return {std::max(0, clamped(from)), std::min(count - 1, clamped(to))};
}

void AddLook(const GroundLook& look, const std::vector<Eigen::Vector2d>& outline, const ViewDetectionOptions& options,
             const GroundCoverage& grid, std::vector<PlaceViews>& cells) {
  const Bounds bounds = Bounds::Of(outline);
  const PosedFrame frame(look);
  const auto [top, bottom] =
      CellsOf(grid.north_rad - bounds.north_rad, grid.north_rad - bounds.south_rad, grid.row_rad, grid.rows);
  const auto [left, right] =
      CellsOf(bounds.west_rad - grid.west_rad, bounds.east_rad - grid.west_rad, grid.column_rad, grid.columns);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const std::size_t cell =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
      if (grid.in_area[cell] == 0) continue;
      GeodeticPoint middle{grid.north_rad - (row + 0.5) * grid.row_rad,
                           grid.west_rad + (column + 0.5) * grid.column_rad, 0};
      const std::optional<double> height_m = look.ground->HeightAt(middle);
      if (!height_m) continue;
      middle.altitude_m = *height_m;
      if (const auto view = frame.ViewOf(middle)) cells[cell].Add(options, *view);
    }
  }
}

void Summarise(const std::vector<PlaceViews>& cells, const std::vector<SearchedModel>& models,
               const ViewDetectionOptions& options, GroundCoverage& coverage) {
  for (const PlaceViews& cell : cells) {
    const PlaceView* nearest = cell.Nearest();
    coverage.looks.push_back(cell.looks());
    coverage.views.push_back(static_cast<std::uint16_t>(cell.views().size()));
    coverage.off_nadir_rad.push_back(nearest == nullptr ? 0 : std::acos(std::clamp(nearest->to_camera.z(), -1.F, 1.F)));
  }
  for (const SearchedModel& model : models) {
    ModelCoverage one{.model = model.name, .diagonal_m = model.diagonal_m, .probability = {}, .size_px = {}};
    for (const PlaceViews& cell : cells) {
      const PlaceView* nearest = cell.Nearest();
      one.probability.push_back(static_cast<float>(FindProbability(options, cell.views(), model.diagonal_m)));
      one.size_px.push_back(nearest == nullptr ? 0 : static_cast<float>(model.diagonal_m * nearest->px_per_m));
    }
    coverage.models.push_back(std::move(one));
  }
}

}  // namespace

std::vector<GeodeticPoint> GroundOutline(const GroundLook& look) {
  constexpr int kPointsOfSide = 8;
  if (!look.camera.IsComplete() || look.width_px <= 0 || look.height_px <= 0) return {};
  const PosedFrame frame(look);
  std::vector<GeodeticPoint> outline;
  const std::array<Eigen::Vector2d, 5> corners = {Eigen::Vector2d(0, 0), Eigen::Vector2d(look.width_px, 0),
                                                  Eigen::Vector2d(look.width_px, look.height_px),
                                                  Eigen::Vector2d(0, look.height_px), Eigen::Vector2d(0, 0)};
  for (std::size_t side = 0; side < 4; ++side) {
    for (int i = 0; i < kPointsOfSide; ++i) {
      const double along = static_cast<double>(i) / kPointsOfSide;
      if (const auto point = frame.GroundAt((1 - along) * corners[side] + along * corners[side + 1])) {
        outline.push_back(*point);
      }
    }
  }
  return outline;
}

Expected<GroundCoverage> CoverGround(const std::vector<GroundLook>& looks, const std::vector<SearchedModel>& models,
                                     const ViewDetectionOptions& options, const GridRequest& grid) {
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  std::vector<Eigen::Vector2d> all;
  for (const GroundLook& look : looks) {
    const double near_rad = grid.centre ? grid.centre->longitude_rad : looks.front().camera.place.longitude_rad;
    outlines.push_back(FlatOutline(GroundOutline(look), near_rad));
    all.insert(all.end(), outlines.back().begin(), outlines.back().end());
  }
  if (all.empty()) return Fail(ErrorCode::kInvalidArgument, "coverage: no searched frame shows ground");
  if (grid.centre) {
    all = FlatOutline(CircleOutline(*grid.centre, grid.radius_m), grid.centre->longitude_rad);
  }
  // A convex hull in radians is one in metres: a scaling of the axes keeps it.
  Polygon area = ConvexHull(std::move(all));
  if (SignedArea(area) < 0) std::ranges::reverse(area);
  VICTORIOUS_ASSIGN_OR_RETURN(GroundCoverage coverage, MakeGrid(area, grid));
  std::vector<PlaceViews> cells(coverage.CellCount());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (!outlines[i].empty()) AddLook(looks[i], outlines[i], options, coverage, cells);
  }
  Summarise(cells, models, options, coverage);
  return coverage;
}

}  // namespace victorious
