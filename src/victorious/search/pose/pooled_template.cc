#include "victorious/search/pose/pooled_template.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include <Eigen/Core>
#include <Eigen/QR>

#include "victorious/geometry/angles.h"
#include "victorious/geometry/solvers/similarity.h"

namespace victorious {
namespace {

// Keypoints of two views are one if they differ by less, in the image of one of them. Chosen: the affine camera places
// a neighbour's keypoint within some 3 px in a template of 400 px, and SIFT's scales are 2^(1/3) = 1.26 apart.
constexpr float kMaxSameDistance_px = 3;
constexpr float kMaxSameScaleFactor = 1.35F;
constexpr double kMaxSameTurn_rad = 0.4;
// Keypoints that an affine camera is fitted to: twice the four that determine it.
constexpr std::size_t kMinCameraKeypoints = 8;
// Smallest extent of the surface points in depth, relative to their largest, that determines an affine camera.
constexpr double kMinRelativeDepth = 0.02;

// Affine camera of a view: homogeneous surface point (m) to pixel. Views are rendered from a large distance.
using ViewMap = Eigen::Matrix<double, 2, 4>;

std::optional<ViewMap> FitViewMap(const ComparedTemplate& view) {
  if (view.keypoints.size() < kMinCameraKeypoints) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(view.keypoints.size());
  Eigen::MatrixX4d places(count, 4);
  Eigen::MatrixX2d pixels(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point3& place = view.points_in_model[static_cast<std::size_t>(i)];
    const Keypoint& keypoint = view.keypoints[static_cast<std::size_t>(i)];
    places.row(i) << place.x, place.y, place.z, 1;
    pixels.row(i) << keypoint.x, keypoint.y;
  }
  // Centred and scaled, so that the rank test rejects clusters and planes of points, which do not determine the map.
  const Eigen::RowVector4d middle(places.col(0).mean(), places.col(1).mean(), places.col(2).mean(), 0);
  places.rowwise() -= middle;
  const double spread = places.leftCols<3>().norm() / std::sqrt(static_cast<double>(count));
  if (!(spread > 0)) return std::nullopt;
  places.leftCols<3>() /= spread;
  Eigen::ColPivHouseholderQR<Eigen::MatrixX4d> decomposition(places);
  decomposition.setThreshold(kMinRelativeDepth);
  if (decomposition.rank() < 4) return std::nullopt;
  ViewMap map = decomposition.solve(pixels).transpose();
  map.leftCols<3>() /= spread;
  map.col(3) -= map.leftCols<3>() * middle.head<3>().transpose();
  return map;
}

// A neighbour's keypoints in the view's image: positions through the affine camera, orientations and scales through
// the one similarity that fits best. Empty if no similarity fits.
std::vector<Keypoint> TransferKeypoints(const ComparedTemplate& neighbour, const ViewMap& map) {
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < neighbour.keypoints.size(); ++i) {
    const Point3& place = neighbour.points_in_model[i];
    pairs.push_back({.source = {neighbour.keypoints[i].x, neighbour.keypoints[i].y},
                     .target = map * Eigen::Vector4d(place.x, place.y, place.z, 1)});
  }
  const std::optional<Similarity2> turned = SolveSimilarity(pairs);
  if (!turned) return {};
  std::vector<Keypoint> transferred(neighbour.keypoints.begin(), neighbour.keypoints.end());
  for (std::size_t i = 0; i < transferred.size(); ++i) {
    transferred[i].x = static_cast<float>(pairs[i].target.x());
    transferred[i].y = static_cast<float>(pairs[i].target.y());
    transferred[i].scale_px = static_cast<float>(transferred[i].scale_px * turned->scale);
    transferred[i].orientation_rad =
        static_cast<float>(WrapAngle(transferred[i].orientation_rad + turned->rotation_rad));
  }
  return transferred;
}

// Hash grid that finds a keypoint of similar position, scale and orientation.
class KeypointGrid {
 public:
  void Add(const Keypoint& keypoint, std::uint32_t number) {
    cells_[CellOf(CellAlong(keypoint.x), CellAlong(keypoint.y))].push_back(number);
  }

  [[nodiscard]] std::optional<std::uint32_t> Find(const Keypoint& wanted, std::span<const Keypoint> keypoints) const {
    for (std::int32_t x = CellAlong(wanted.x) - 1; x <= CellAlong(wanted.x) + 1; ++x) {
      for (std::int32_t y = CellAlong(wanted.y) - 1; y <= CellAlong(wanted.y) + 1; ++y) {
        const auto cell = cells_.find(CellOf(x, y));
        if (cell == cells_.end()) continue;
        const auto alike =
            std::ranges::find_if(cell->second, [&](std::uint32_t one) { return AreSimilar(wanted, keypoints[one]); });
        if (alike != cell->second.end()) return *alike;
      }
    }
    return std::nullopt;
  }

 private:
  static std::int32_t CellAlong(float px) { return static_cast<std::int32_t>(std::floor(px / kMaxSameDistance_px)); }
  static std::uint64_t CellOf(std::int32_t x, std::int32_t y) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U | static_cast<std::uint32_t>(y);
  }

  static bool AreSimilar(const Keypoint& a, const Keypoint& b) {
    return std::hypot(a.x - b.x, a.y - b.y) <= kMaxSameDistance_px &&
           std::max(a.scale_px, b.scale_px) <= kMaxSameScaleFactor * std::min(a.scale_px, b.scale_px) &&
           std::abs(WrapAngle(a.orientation_rad - b.orientation_rad)) <= kMaxSameTurn_rad;
  }

  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

PooledTemplate PoolTemplates(const ComparedTemplate& view, std::span<const ComparedTemplate> neighbours) {
  PooledTemplate pooled{.keypoints = {view.keypoints.begin(), view.keypoints.end()},
                        .points_in_model = {view.points_in_model.begin(), view.points_in_model.end()},
                        .matches = {view.matches.begin(), view.matches.end()}};
  const std::optional<ViewMap> map = FitViewMap(view);
  if (!map) return pooled;

  KeypointGrid grid;
  for (std::uint32_t i = 0; i < pooled.keypoints.size(); ++i) grid.Add(pooled.keypoints[i], i);
  std::vector<std::uint32_t> view_count(pooled.keypoints.size(), 1);  // number of views that contain the keypoint
  for (const ComparedTemplate& neighbour : neighbours) {
    const std::vector<Keypoint> transferred = TransferKeypoints(neighbour, *map);
    std::vector<std::uint32_t> number(transferred.size());
    for (std::size_t i = 0; i < transferred.size(); ++i) {
      const auto same = grid.Find(transferred[i], pooled.keypoints);
      number[i] = same.value_or(static_cast<std::uint32_t>(pooled.keypoints.size()));
      if (same) {
        ++view_count[*same];
        continue;
      }
      grid.Add(transferred[i], number[i]);
      pooled.keypoints.push_back(transferred[i]);
      pooled.points_in_model.push_back(neighbour.points_in_model[i]);
      view_count.push_back(1);
    }
    if (transferred.empty()) continue;
    for (const RankedMatch& match : neighbour.matches) {
      pooled.matches.push_back({match.scene_keypoint, number[match.template_keypoint], match.rank});
    }
  }
  for (RankedMatch& match : pooled.matches) match.rank *= view_count[match.template_keypoint];
  std::ranges::stable_sort(pooled.matches, {}, &RankedMatch::template_keypoint);
  return pooled;
}

}  // namespace victorious
