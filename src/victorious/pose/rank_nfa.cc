#include "victorious/pose/rank_nfa.h"

#include <algorithm>
#include <cmath>

#include "victorious/base/binomial.h"
#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

Eigen::Vector2d PlaceOf(const Keypoint& keypoint) { return {keypoint.x, keypoint.y}; }

// Predicate: the template keypoint projects into the searched region and is large enough there to be detected.
class Visibility {
 public:
  Visibility(const Similarity2& pose, const FeatureSet& scene, double least_scale_px)
      : pose_(pose), linear_(pose.Linear()), searched_(scene.Searched()), least_scale_px_(least_scale_px) {}

  bool operator()(const Keypoint& keypoint) const {
    const Eigen::Vector2d place = linear_ * PlaceOf(keypoint) + pose_.translation;
    return keypoint.scale_px * pose_.scale >= least_scale_px_ && searched_.Contains(place.x(), place.y());
  }

 private:
  const Similarity2& pose_;
  Eigen::Matrix2d linear_;
  Box searched_;
  double least_scale_px_;
};

// The fraction of scene keypoints that agree with the projection of a template keypoint in position, scale and
// orientation: p for rank 1. Counted over windows twice as wide, since narrow windows hold few keypoints or none, and
// then reduced by the ratio of the windows.
double ShareThatAgrees(const Keypoint& keypoint, const Similarity2& pose, const PoseWindow& window,
                       const FeatureSet& scene, const VoteOptions& options) {
  constexpr double kWider = 2;
  const double turn_window_rad = std::min(kPi, options.turn_rad);
  const double wide_turn_rad = std::min(kPi, kWider * turn_window_rad);
  constexpr double kLeastCount = 0.1;
  const Eigen::Vector2d place = pose.Apply(PlaceOf(keypoint));
  const double reach_px = kWider * window.widest_px;
  const double scale_px = keypoint.scale_px * pose.scale;
  const double turn_rad = keypoint.orientation_rad + pose.rotation_rad;
  int count = 0;
  for (const Keypoint& other : scene.keypoints) {
    if ((PlaceOf(other) - place).squaredNorm() > reach_px * reach_px) continue;
    if (other.scale_px > options.scale_factor * scale_px || other.scale_px * options.scale_factor < scale_px) continue;
    if (std::abs(WrapAngle(other.orientation_rad - turn_rad)) > wide_turn_rad) continue;
    ++count;
  }
  const double narrower = reach_px / window.radius_px;
  const double wider = narrower * narrower * wide_turn_rad / turn_window_rad;
  return std::max(kLeastCount, count / wider) / static_cast<double>(scene.size());
}

// True if two scene descriptors belong to a repeated texture: their distance is below that of most true matches.
// Descriptors have a norm of about 512.
bool LookAlike(const FeatureSet& scene, std::size_t a, std::size_t b) {
  constexpr int kAlike = 150;
  if (scene.descriptors.empty()) return false;  // positions only
  const auto of_a = scene.View().Descriptor(a);
  const auto of_b = scene.View().Descriptor(b);
  int squared = 0;
  for (std::size_t i = 0; i < kDescriptorSize; ++i) squared += (of_a[i] - of_b[i]) * (of_a[i] - of_b[i]);
  return squared < kAlike * kAlike;
}

// The chance p of each independent inlier, ascending. Omits an inlier that overlaps one of lower rank in the scene or
// has a similar descriptor: false matches on a repeated texture, the joints of a pavement for example, come together.
std::vector<double> Chances(const Similarity2& pose, std::span<const RankedMatch> inliers, const PoseWindow& window,
                            const FeatureSet& scene, std::span<const Keypoint> model, const VoteOptions& options) {
  std::vector<RankedMatch> by_rank(inliers.begin(), inliers.end());
  std::ranges::stable_sort(by_rank, {}, &RankedMatch::rank);
  std::vector<std::size_t> taken;
  std::vector<double> chances;
  for (const RankedMatch& match : by_rank) {
    const Keypoint& keypoint = scene.keypoints[match.scene];
    const bool tells_nothing = std::ranges::any_of(taken, [&](std::size_t known) {
      const Keypoint& other = scene.keypoints[known];
      const double reach_px = options.apart * std::max(keypoint.scale_px, other.scale_px);
      return (PlaceOf(keypoint) - PlaceOf(other)).norm() < reach_px || LookAlike(scene, match.scene, known);
    });
    if (tells_nothing) continue;
    taken.push_back(match.scene);
    chances.push_back(std::min(1.0, match.rank * ShareThatAgrees(model[match.model], pose, window, scene, options)));
  }
  std::ranges::sort(chances);
  return chances;
}

// log10 of the number T of distinguishable poses: positions one window apart, times rotations (full circle) and scales
// (four octaves) that move the object's rim by one window.
double PoseDecades(const Similarity2& pose, double radius_px, double size_px, const FeatureSet& scene) {
  const double windows = scene.Searched().Area() / (kPi * radius_px * radius_px);
  const double rim = std::max(1.0, 0.5 * size_px * pose.scale / radius_px);
  const double octaves = 4 * std::log(2.0);
  return std::log10(std::max(1.0, windows)) + std::log10(2 * kPi * rim) + std::log10(octaves * rim);
}

}  // namespace

double RankEvidence(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                    const PoseWindow& window, double size_px, const FeatureSet& scene, std::span<const Keypoint> model,
                    const VoteOptions& options) {
  const std::vector<double> chances = Chances(scene_from_template, inliers, window, scene, model, options);
  const Visibility visible(scene_from_template, scene, options.least_scale_px);
  // The windows admit inliers slightly outside the frame or slightly too small. They count in n, so that k <= n.
  const auto expected = std::ranges::count_if(model, visible);
  const auto unexpected =
      std::ranges::count_if(inliers, [&](const RankedMatch& match) { return !visible(model[match.model]); });
  const auto n = static_cast<double>(expected + unexpected);
  double least_log = 0;  // of C(n, k) p_k^k
  for (std::size_t i = 0; i < chances.size(); ++i) {
    const double k = static_cast<double>(i + 1);
    least_log = std::min(least_log, LogChoose(n, k) + k * std::log(chances[i]));
  }
  return -least_log / std::log(10.0) - PoseDecades(scene_from_template, window.radius_px, size_px, scene) -
         options.dependence_decades;
}

}  // namespace victorious
