#include "victorious/search/recognize/contour_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinReach_px = 3;
constexpr double kFirstMinReach_px = 4;
constexpr int kMaxReach_px = 16;
constexpr double kMaxGradient = 15;      // grey levels a pixel: stronger edges are not likelier
constexpr double kTukey = 1.3;           // cut-off over the reach
constexpr int kMinPoints = 10;           // that have an edge
constexpr double kMaxTurn_rad = 0.2;     // in one iteration
constexpr double kFocalSigma = 0.25;     // of its logarithm
constexpr double kDistanceSigma_px = 2;  // of a point, for the weight of the focal length's prior
constexpr double kDamping = 1e-3;
constexpr double kHitOfRight = 0.9;
constexpr double kSpacing = 1.0 / 70;  // of points, of the object's size
constexpr double kIndependent_px = 8;
constexpr double kSurrounding = 0.2;  // around the object's box
constexpr int kMinSide_px = 20;
constexpr int kProfile_px = 8;  // on either side of a contour

constexpr int kUnknowns = 7;  // rotation; translation, of the object's size; logarithm of the focal length
using Normals = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

double ContourSizePx(const ContourModel& model, const ContourPose& pose) {
  return pose.focal_px * model.diagonal_m / pose.centre_in_camera_m.z();
}

// The distance along the normal to the edge that is strong and near. std::nullopt: no edge.
std::optional<double> DistanceToEdge(const ContourImage& image, const ProjectedContour& point, double reach_px) {
  const int reach = static_cast<int>(std::ceil(reach_px));
  std::array<double, 2 * kMaxReach_px + 5> gradients{};
  const auto count = static_cast<std::size_t>(2 * reach + 3);
  for (std::size_t i = 0; i < count; ++i) {
    const double along_px = static_cast<double>(i) - reach - 1;
    gradients[i] = image.GradientAlong(point.at_px + along_px * point.normal, point.normal);
  }
  double best = 0;
  std::optional<double> distance_px;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    if (gradients[i] <= 0 || gradients[i] < gradients[i - 1] || gradients[i] < gradients[i + 1]) continue;
    double along_px = static_cast<double>(i) - reach - 1;
    const double curvature = gradients[i - 1] - 2 * gradients[i] + gradients[i + 1];
    if (curvature < 0) along_px += 0.5 * (gradients[i - 1] - gradients[i + 1]) / curvature;
    const double sigma_px = reach_px / 2;
    const double weight =
        std::min(gradients[i], kMaxGradient) * std::exp(-along_px * along_px / (2 * sigma_px * sigma_px));
    if (weight <= best) continue;
    best = weight;
    distance_px = along_px;
  }
  return distance_px;
}

// How far a point moves along its normal with each unknown.
Unknowns Derivatives(const ContourModel& model, const ContourPose& pose, const Vector2d& principal_px,
                     const ProjectedContour& point) {
  const Vector3d& at = point.in_camera_m;
  const double scale = pose.focal_px / at.z();
  const Vector3d moved(scale * point.normal.x(), scale * point.normal.y(),
                       -scale * point.normal.dot(at.head<2>()) / at.z());
  Unknowns derivatives;
  derivatives.head<3>() = (at - pose.centre_in_camera_m).cross(moved);
  derivatives.segment<3>(3) = model.diagonal_m * moved;
  derivatives[6] = point.normal.dot(point.at_px - principal_px);
  return derivatives;
}

// One step of Gauss and Newton. False if too few points have an edge, or the pose is impossible.
bool ImprovePose(const ContourModel& model, const ContourImage& image, double reach_px, double assumed_focal_px,
                 const ContourRefineOptions& options, ContourPose& pose) {
  Normals normals = Normals::Zero();
  Unknowns right = Unknowns::Zero();
  int count = 0;
  for (const ProjectedContour& point : ProjectContours(model, pose, image.centre_px(), options.stride)) {
    const std::optional<double> distance_px = DistanceToEdge(image, point, reach_px);
    if (!distance_px) continue;
    const double relative = *distance_px / (kTukey * reach_px);
    if (std::abs(relative) >= 1) continue;
    const double weight = (1 - relative * relative) * (1 - relative * relative);
    const Unknowns derivatives = Derivatives(model, pose, image.centre_px(), point);
    normals += weight * derivatives * derivatives.transpose();
    right += weight * *distance_px * derivatives;
    ++count;
  }
  if (count < kMinPoints) return false;
  for (int i = 0; i < kUnknowns - 1; ++i) normals(i, i) += kDamping * (normals(i, i) + count);
  if (options.free_focal) {
    const double weight = count * kDistanceSigma_px * kDistanceSigma_px / (kFocalSigma * kFocalSigma);
    normals(6, 6) += weight;
    right[6] -= weight * std::log(pose.focal_px / assumed_focal_px);
  } else {
    normals.row(6).setZero();
    normals.col(6).setZero();
    normals(6, 6) = 1;
    right[6] = 0;
  }
  Unknowns change = normals.ldlt().solve(right);
  if (!change.allFinite()) return false;
  const double turn_rad = change.head<3>().norm();
  if (turn_rad > kMaxTurn_rad) change *= kMaxTurn_rad / turn_rad;
  const Vector3d turn = change.head<3>();
  if (turn.norm() > 0) {
    pose.camera_from_model =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * pose.camera_from_model;
  }
  pose.centre_in_camera_m += model.diagonal_m * change.segment<3>(3);
  pose.focal_px *= std::exp(change[6]);
  return pose.centre_in_camera_m.z() > model.diagonal_m / 2;
}

// ContourEvidence::step: the sums of the differences and of the ranges of the points' profiles along the normals.
double StepOf(const cv::Mat& grey, std::span<const ProjectedContour> points) {
  const cv::Rect image({0, 0}, grey.size());
  double steps = 0;
  double ranges = 0;
  for (const ProjectedContour& point : points) {
    const auto pixel = [&](int along_px) {
      const Vector2d at = point.at_px + along_px * point.normal;
      return cv::Point(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())));
    };
    if (!image.contains(pixel(-kProfile_px)) || !image.contains(pixel(kProfile_px))) continue;
    const int before = grey.at<std::uint8_t>(pixel(-kProfile_px));
    const int behind = grey.at<std::uint8_t>(pixel(kProfile_px));
    int low = std::min(before, behind);
    int high = std::max(before, behind);
    for (int along_px = 1 - kProfile_px; along_px < kProfile_px; ++along_px) {
      const int level = grey.at<std::uint8_t>(pixel(along_px));
      low = std::min(low, level);
      high = std::max(high, level);
    }
    steps += std::abs(behind - before);
    ranges += high - low;
  }
  return ranges > 0 ? steps / ranges : 0;
}

const ContourView& NearestView(const ContourModel& model, const ContourPose& pose) {
  const Vector3d away = pose.camera_from_model.transpose() * pose.centre_in_camera_m.normalized();
  return *std::ranges::max_element(model.views, {},
                                   [&](const ContourView& view) { return view.camera_from_model.row(2).dot(away); });
}

}  // namespace

std::vector<ProjectedContour> ProjectContours(const ContourModel& model, const ContourPose& pose,
                                              const Vector2d& principal_px, std::size_t stride) {
  const ContourView& view = NearestView(model, pose);
  std::vector<ProjectedContour> projected;
  projected.reserve(view.points.size() / stride + 1);
  for (std::size_t i = 0; i < view.points.size(); i += stride) {
    const Vector3d at = pose.camera_from_model * view.points[i].position_m + pose.centre_in_camera_m;
    const Vector3d beside = pose.camera_from_model * view.points[i].beside_m + pose.centre_in_camera_m;
    if (!(at.z() > 0) || !(beside.z() > 0)) continue;
    const Vector2d at_px = pose.focal_px * at.head<2>() / at.z();
    const Vector2d tangent = pose.focal_px * beside.head<2>() / beside.z() - at_px;
    if (tangent.norm() < std::numeric_limits<double>::min()) continue;
    projected.push_back({at_px + principal_px, Vector2d(-tangent.y(), tangent.x()).normalized(), at});
  }
  return projected;
}

ContourPose RefineContourPose(const ContourModel& model, const ContourImage& image, ContourPose pose,
                              const ContourRefineOptions& options) {
  const double assumed_focal_px = pose.focal_px;
  for (int i = 0; i < options.iterations; ++i) {
    const double first_px =
        std::clamp(options.reach * ContourSizePx(model, pose), kFirstMinReach_px, static_cast<double>(kMaxReach_px));
    const double reach_px = std::max(kMinReach_px, first_px * std::pow(options.reach_factor, i));
    ContourPose next = pose;
    if (!ImprovePose(model, image, reach_px, assumed_focal_px, options, next)) break;
    pose = next;
  }
  return pose;
}

ContourEvidence EvidenceOf(const ContourModel& model, const ContourImage& image, const ContourPose& pose,
                           const std::function<bool(const Vector2d&)>& is_seen) {
  std::vector<ProjectedContour> points = ProjectContours(model, pose, image.centre_px());
  if (points.empty()) return {};
  const auto count = static_cast<double>(points.size());
  Vector2d low = points.front().at_px;
  Vector2d high = low;
  for (const ProjectedContour& point : points) {
    low = low.cwiseMin(point.at_px);
    high = high.cwiseMax(point.at_px);
  }
  ContourEvidence evidence{.box = {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()}};
  const Vector2d margin = kSurrounding * (high - low);
  const Vector2d frame(image.grey().cols, image.grey().rows);
  const Vector2d from = (low - margin).cwiseMax(Vector2d::Zero()).cwiseMin(frame);
  const Vector2d to = (high + margin).cwiseMax(Vector2d::Zero()).cwiseMin(frame);
  const cv::Rect around(cv::Point(static_cast<int>(from.x()), static_cast<int>(from.y())),
                        cv::Point(static_cast<int>(to.x()), static_cast<int>(to.y())));
  if (around.width < kMinSide_px || around.height < kMinSide_px) return evidence;
  const std::array<double, kEdgeOrientations> fractions = image.EdgeFractions(around);
  if (is_seen) std::erase_if(points, [&](const ProjectedContour& point) { return !is_seen(point.at_px); });
  evidence.seen = static_cast<double>(points.size()) / count;
  for (const ProjectedContour& point : points) {
    const int bin = OrientationBin(point.normal.x(), point.normal.y(), kEdgeOrientations);
    const double by_chance = fractions[static_cast<std::size_t>(bin)];
    const bool is_hit = image.HasEdge(point.at_px, bin);
    if (is_hit) evidence.hit_fraction += 1 / count;
    evidence.mean += is_hit ? std::log10(kHitOfRight / by_chance) : std::log10((1 - kHitOfRight) / (1 - by_chance));
  }
  evidence.step = StepOf(image.grey(), points);
  evidence.decades = evidence.mean * kSpacing * ContourSizePx(model, pose) / kIndependent_px;
  evidence.mean /= count;
  return evidence;
}

}  // namespace victorious
