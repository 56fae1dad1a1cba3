#include "victorious/place/calibrate/motion_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "victorious/base/median.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/camera.h"
#include "victorious/types/frame.h"

namespace victorious {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Sample points of the image motion, halfway to the image corners, relative to the centre, px.
std::array<Vector2d, 4> Corners(const cv::Size& image) {
  const double x = image.width / 4.0;
  const double y = image.height / 4.0;
  return {Vector2d(-x, -y), Vector2d(x, -y), Vector2d(x, y), Vector2d(-x, y)};
}

// Converts the shifts of the four points to motion components: right, down, rotation, all in px.
Vector3d Components(const std::array<Vector2d, 4>& corners, const std::array<Vector2d, 4>& shifts) {
  Vector2d mean = Vector2d::Zero();
  double turn = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    mean += shifts[k] / 4;
    turn += (corners[k].x() * shifts[k].y() - corners[k].y() * shifts[k].x()) / 4;
  }
  return {mean.x(), mean.y(), turn / corners[0].norm()};
}

}  // namespace

std::optional<PlanePose> PoseAt(const CameraTrajectory& cameras, double time_s, const TangentPlane& plane,
                                int image_width) {
  const auto state = cameras.At(time_s);
  if (!state || !state->attitude || !state->hfov_rad) return std::nullopt;
  return PlanePose{plane.EnuFromGeodetic(state->place), CameraFromEnu(*state->attitude),
                   FocalLengthPx(*state->hfov_rad, image_width)};
}

MotionComparison::MotionComparison(const ImageMotions& seen, const CameraTrajectory& cameras)
    : seen_(seen), cameras_(cameras), plane_(cameras.states().front().place), corners_(Corners(seen.image)) {
  std::vector<double> heights_m;
  std::vector<double> heights_then_m;  // of the states during the motions
  for (const CameraState& state : cameras.states()) {
    heights_m.push_back(plane_.EnuFromGeodetic(state.place).z());
    if (seen.motions.empty() || state.time_s < seen.motions.front().from_s || state.time_s > seen.motions.back().to_s)
      continue;
    heights_then_m.push_back(heights_m.back());
  }
  height_m_ = MedianOr(std::move(heights_then_m), Median(std::move(heights_m)));
  const Vector2d middle(seen.image.width / 2.0, seen.image.height / 2.0);
  for (const ImageMotion& motion : seen.motions) {
    std::array<Vector2d, 4> shifts;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      shifts[k] = motion.to_from.Apply(corners_[k] + middle) - middle - corners_[k];
    }
    measured_.push_back(Components(corners_, shifts));
    sums_.push_back(sums_.empty() ? measured_.back() : Vector3d(sums_.back() + measured_.back()));
  }
}

std::optional<Vector3d> MotionComparison::MeanMeasured(std::size_t i, double apart_s) const {
  Vector3d sum = Vector3d::Zero();
  for (const double shift_s : {-apart_s / 2, apart_s / 2}) {
    const auto from = SumAt(seen_.motions[i].from_s + shift_s);
    const auto to = SumAt(seen_.motions[i].to_s + shift_s);
    if (!from || !to) return std::nullopt;
    sum += (*to - *from) / 2;
  }
  return sum;
}

MotionComparison::Poses MotionComparison::PosesAt(double offset_s) const {
  Poses poses(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const auto from = PoseAt(cameras_, seen_.motions[i].from_s - offset_s, plane_, seen_.image.width);
    const auto to = PoseAt(cameras_, seen_.motions[i].to_s - offset_s, plane_, seen_.image.width);
    if (from && to) poses[i].emplace(*from, *to);
  }
  return poses;
}

double MotionComparison::GroundAltitude(const Vector3d& place, double per_m) const {
  return plane_.GeodeticFromEnu({place.x(), place.y(), height_m_ - 1 / per_m}).altitude_m;
}

std::optional<Vector3d> MotionComparison::Predict(const std::pair<PlanePose, PlanePose>& pair, double per_m) const {
  std::array<Vector2d, 4> shifts;
  const auto& [from, to] = pair;
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const Vector3d ray = from.camera_from_plane.conjugate() *
                         Vector3d(corners_[k].x() / from.focal_px, corners_[k].y() / from.focal_px, 1);
    // A ground point at d along the ray, divided by d: (place + d ray - place') / d. Rays above the horizon are at
    // infinity.
    const double above = 1 + per_m * (from.place.z() - height_m_);  // camera height relative to the median
    const double per_ray = above > 0 ? per_m * std::max(0.0, -ray.z()) / above : 0;
    const Vector3d there = to.camera_from_plane * (ray + per_ray * (from.place - to.place));
    if (!(there.z() > 0)) return std::nullopt;
    shifts[k] = to.focal_px * there.hnormalized() - corners_[k];
  }
  return Components(corners_, shifts);
}

std::optional<Vector3d> MotionComparison::SumAt(double time_s) const {
  const std::vector<ImageMotion>& motions = seen_.motions;
  const auto pair = std::ranges::lower_bound(motions, time_s - kSameTime_s, {}, &ImageMotion::to_s);
  if (pair == motions.end() || pair->from_s > time_s + kSameTime_s) return std::nullopt;
  const auto i = static_cast<std::size_t>(pair - motions.begin());
  return sums_[i] - std::max(0.0, (pair->to_s - time_s) / (pair->to_s - pair->from_s)) * measured_[i];
}

ResidualSet ComputeResiduals(const MotionComparison& comparison, const MotionComparison::Poses& poses, double per_m) {
  ResidualSet residual_set;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto predicted = poses[i] ? comparison.Predict(*poses[i], per_m) : std::nullopt;
    if (!predicted) continue;
    residual_set.pairs.push_back(i);
    residual_set.residuals.push_back(comparison.measured(i) - *predicted);
  }
  return residual_set;
}

SecondMotions AverageSeconds(const MotionComparison& comparison, const ResidualSet& residual_set) {
  constexpr std::size_t kMinPairsInSecond = 5;
  std::map<std::int64_t, std::vector<std::size_t>> of_second;
  for (std::size_t k = 0; k < residual_set.pairs.size(); ++k)
    of_second[static_cast<std::int64_t>(std::floor(comparison.time_s(residual_set.pairs[k])))].push_back(k);
  SecondMotions seconds;
  for (const auto& [second, pairs] : of_second) {
    if (pairs.size() < kMinPairsInSecond) continue;
    Vector3d seen = Vector3d::Zero();
    Vector3d residual = Vector3d::Zero();
    for (const std::size_t k : pairs) {
      seen += comparison.measured(residual_set.pairs[k]) / static_cast<double>(pairs.size());
      residual += residual_set.residuals[k] / static_cast<double>(pairs.size());
    }
    seconds.seen.push_back(seen);
    seconds.residuals.push_back(residual);
  }
  return seconds;
}

std::optional<BestHeight> FindBestHeight(const MotionComparison& comparison, const MotionComparison::Poses& poses,
                                         const std::function<double(const SecondMotions&)>& cost) {
  constexpr std::size_t kMinSeconds = 4;
  constexpr double kMinHeight_m = 1;
  constexpr double kMaxHeight_m = 6400;
  constexpr double kCoarseStep = 1.5;
  // A camera that circles turns by as much as it moves: of the motion that its way alone would cause, so much remains.
  constexpr double kFineStep = 1.02;
  std::optional<BestHeight> best;
  const auto try_heights = [&](double from_m, double to_m, double step) {
    for (double height_m = from_m; height_m <= to_m; height_m *= step) {
      SecondMotions seconds = AverageSeconds(comparison, ComputeResiduals(comparison, poses, 1 / height_m));
      if (seconds.residuals.size() < kMinSeconds) continue;
      const double here = cost(seconds);
      if (best && here >= best->cost) continue;
      best = BestHeight{.per_m = 1 / height_m, .cost = here, .seconds = std::move(seconds)};
    }
  };
  try_heights(kMinHeight_m, kMaxHeight_m, kCoarseStep);
  const double coarse_m = best ? 1 / best->per_m : kMinHeight_m;
  try_heights(coarse_m / kCoarseStep, coarse_m * kCoarseStep, kFineStep);
  return best;
}

Vector3d Medians(const std::vector<Vector3d>& values) {
  Vector3d middle;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> one;
    for (const Vector3d& value : values) one.push_back(value[c]);
    middle[c] = Median(std::move(one));
  }
  return middle;
}

}  // namespace victorious
