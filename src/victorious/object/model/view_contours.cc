#include "victorious/object/model/view_contours.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Geometry>

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinStep = 0.03;       // in depth, of the object's size
constexpr double kMaxPlaneStep = 0.02;  // in depth between two pixels of a plane on either side of a crease
constexpr double kMinCrease_rad = 0.5;
constexpr double kMargin_px = 0.1;           // of a crease beyond its two pixels: rounding of depths
constexpr double kSpacing = 1.0 / 70;        // of points, of the object's size
constexpr double kNeighbourhood = 1.0 / 50;  // radius, of the object's size
constexpr double kMinNeighbourhood_px = 4;
constexpr std::size_t kMinNeighbours = 4;
constexpr double kMaxNeighbourDepth = 0.1;  // difference, of the object's size
constexpr double kMaxWidth = 0.12;          // variance across a line over that along it

enum class EdgeKind { kStep, kCrease };

// Between two pixels.
struct RawPoint {
  Vector2d at_px;
  double inverse_depth = 0;  // 1 / m
  EdgeKind kind = EdgeKind::kStep;
};

// Inverse depths along a row or a column; 0: none.
class Line {
 public:
  Line(const cv::Mat& depth_m, int number, bool is_row) : depth_m_(depth_m), number_(number), is_row_(is_row) {}

  [[nodiscard]] double at(int i) const {
    const int row = is_row_ ? number_ : i;
    const int column = is_row_ ? i : number_;
    if (row < 0 || column < 0 || row >= depth_m_.rows || column >= depth_m_.cols) return 0;
    const float depth_m = depth_m_.at<float>(row, column);
    return std::isnan(depth_m) ? 0 : 1 / static_cast<double>(depth_m);
  }
  // @param along_px  the middle of pixel i is at i + 0.5
  [[nodiscard]] Vector2d PointAt(double along_px) const {
    return is_row_ ? Vector2d(along_px, number_ + 0.5) : Vector2d(number_ + 0.5, along_px);
  }

 private:
  const cv::Mat& depth_m_;
  int number_;
  bool is_row_;
};

// The edge between the pixels i and i + 1, if there is one.
std::optional<RawPoint> EdgeBetween(const Line& line, int i, double focal_px, double size_m) {
  const double a = line.at(i);
  const double b = line.at(i + 1);
  if (a == 0 && b == 0) return std::nullopt;
  if (a == 0 || b == 0) return RawPoint{line.PointAt(i + 1), std::max(a, b), EdgeKind::kStep};
  const double before = line.at(i - 1) > 0 ? a - line.at(i - 1) : 0;
  const double after = line.at(i + 2) > 0 ? line.at(i + 2) - b : 0;
  const double m_per_inverse = 1 / (a * a);  // depth changes by this times the change of the inverse depth
  const double step_m = std::min(std::abs(b - a - before), std::abs(b - a - after)) * m_per_inverse;
  if (step_m > kMinStep * size_m) return RawPoint{line.PointAt(i + 1), std::max(a, b), EdgeKind::kStep};
  const double first = line.at(i - 2);
  const double last = line.at(i + 3);
  if (first == 0 || last == 0) return std::nullopt;
  const double max_change = kMaxPlaneStep * size_m / m_per_inverse;
  if (std::abs(std::abs(line.at(i - 1) - first) - std::abs(before)) > max_change ||
      std::abs(std::abs(last - line.at(i + 2)) - std::abs(after)) > max_change) {
    return std::nullopt;
  }
  const double slope_before = (a - first) / 2;
  const double slope_after = (last - b) / 2;
  const double pixel_m = 1 / (a * focal_px);
  const double angle_rad =
      std::atan(slope_before * m_per_inverse / pixel_m) - std::atan(slope_after * m_per_inverse / pixel_m);
  if (std::abs(angle_rad) < kMinCrease_rad) return std::nullopt;
  const double meets = (b - slope_after - a) / (slope_before - slope_after);
  if (meets < -kMargin_px || meets > 1 + kMargin_px) return std::nullopt;
  return RawPoint{line.PointAt(i + 0.5 + meets), a + slope_before * meets, EdgeKind::kCrease};
}

std::vector<RawPoint> FindRawPoints(const PosedDepthMap& depth_map, double size_m) {
  std::vector<RawPoint> found;
  const cv::Mat& depth_m = depth_map.depth_m;
  for (const bool is_row : {true, false}) {
    const int lines = is_row ? depth_m.rows : depth_m.cols;
    const int length = is_row ? depth_m.cols : depth_m.rows;
    for (int number = 0; number < lines; ++number) {
      const Line line(depth_m, number, is_row);
      for (int i = -1; i < length; ++i) {
        if (const auto point = EdgeBetween(line, i, depth_map.camera.pinhole.fx, size_m)) found.push_back(*point);
      }
    }
  }
  return found;
}

using CellNumber = std::pair<int, int>;

CellNumber CellOf(const Vector2d& at_px, double side_px) {
  return {static_cast<int>(std::floor(at_px.x() / side_px)), static_cast<int>(std::floor(at_px.y() / side_px))};
}

// The points of a neighbourhood as a line; inverse depth is linear along it.
struct FittedLine {
  Vector2d centre_px;
  Vector2d direction;
  double inverse_depth = 0;  // at the centre
  double slope = 0;          // of the inverse depth, a pixel
};

std::optional<FittedLine> FitLine(const std::vector<const RawPoint*>& points) {
  if (points.size() < kMinNeighbours) return std::nullopt;
  FittedLine line{.centre_px = Vector2d::Zero(), .direction = Vector2d::UnitX()};
  for (const RawPoint* point : points) {
    line.centre_px += point->at_px / static_cast<double>(points.size());
    line.inverse_depth += point->inverse_depth / static_cast<double>(points.size());
  }
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const RawPoint* point : points) {
    const Vector2d offset = point->at_px - line.centre_px;
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solved(scatter);
  if (solved.eigenvalues()[0] > kMaxWidth * solved.eigenvalues()[1]) return std::nullopt;
  line.direction = solved.eigenvectors().col(1);
  for (const RawPoint* point : points) {
    const double along_px = line.direction.dot(point->at_px - line.centre_px);
    line.slope += along_px * (point->inverse_depth - line.inverse_depth) / solved.eigenvalues()[1];
  }
  return line;
}

}  // namespace

std::vector<ContourPoint> ReadContours(const PosedDepthMap& depth_map, const Vector3d& centre_m, double diagonal_m) {
  const PosedCamera& camera = depth_map.camera;
  const double distance_m = camera.camera_from_world.Apply(centre_m).z();
  const double size_px = camera.pinhole.fx * diagonal_m / distance_m;
  const double radius_px = std::max(kMinNeighbourhood_px, kNeighbourhood * size_px);
  const std::vector<RawPoint> raw = FindRawPoints(depth_map, diagonal_m);
  std::map<CellNumber, std::vector<const RawPoint*>> cells;
  for (const RawPoint& point : raw) cells[CellOf(point.at_px, radius_px)].push_back(&point);
  const auto is_neighbour = [&](const RawPoint& a, const RawPoint& b) {
    return a.kind == b.kind && (a.at_px - b.at_px).norm() <= radius_px &&
           std::abs(1 / a.inverse_depth - 1 / b.inverse_depth) <= kMaxNeighbourDepth * diagonal_m;
  };
  const Rigid3 world_from_camera = camera.camera_from_world.Inverse();
  std::set<CellNumber> taken;
  std::vector<ContourPoint> contours;
  for (const RawPoint& point : raw) {
    const CellNumber place = CellOf(point.at_px, std::max(1.0, kSpacing * size_px));
    if (taken.contains(place)) continue;
    std::vector<const RawPoint*> neighbours;
    const auto [x, y] = CellOf(point.at_px, radius_px);
    for (int i = 0; i < 9; ++i) {
      const auto cell = cells.find({x - 1 + i % 3, y - 1 + i / 3});
      if (cell == cells.end()) continue;
      std::ranges::copy_if(cell->second, std::back_inserter(neighbours),
                           [&](const RawPoint* other) { return is_neighbour(point, *other); });
    }
    const std::optional<FittedLine> line = FitLine(neighbours);
    if (!line) continue;
    const auto point_at = [&](double along_px) {
      const Vector2d at_px = line->centre_px + along_px * line->direction;
      const double depth_m = 1 / (line->inverse_depth + along_px * line->slope);
      return Vector3d(world_from_camera.Apply(depth_m * camera.pinhole.Unproject(at_px)) - centre_m);
    };
    const double along_px = line->direction.dot(point.at_px - line->centre_px);
    taken.insert(place);
    contours.push_back({point_at(along_px), point_at(along_px + radius_px / 2)});
  }
  return contours;
}

}  // namespace victorious
