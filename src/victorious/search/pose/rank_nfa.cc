#include "victorious/search/pose/rank_nfa.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "victorious/base/binomial.h"
#include "victorious/geometry/angles.h"
#include "victorious/kernels/vote_agreement.h"

namespace victorious {
namespace {

// Two scene descriptors (of a norm of about 512) that are nearer than this belong to one repeated texture: it is below
// the distance of most true matches. Measured on uav123_10fps/truck4_2, where the joints of an embankment's slabs gave
// two false objects (docs/results/false-alarms.md).
constexpr int kMaxSimilarDistance = 150;
// The scene keypoints that agree with a pose are counted in windows that are wider by this factor than those of an
// inlier: narrow windows hold few keypoints or none.
constexpr double kCountingFactor = 2;
// The count in the narrow windows that an empty wide window stands for: p must not be 0.
constexpr double kMinAgreeingCount = 0.1;
// The range of scales of T, the number of distinguishable poses: an object appears from a quarter to four times the
// size of its template.
constexpr double kScaleRangeOctaves = 4;

Eigen::Vector2d PositionOf(const Keypoint& keypoint) { return {keypoint.x, keypoint.y}; }

// Predicate: the template keypoint projects into the searched region and is large enough there to be detected.
class Visibility {
 public:
  Visibility(const Similarity2& scene_from_template, const FeatureSet& scene, double min_scale_px)
      : scene_from_template_(scene_from_template),
        linear_(scene_from_template.Linear()),
        searched_(scene.SearchedBox()),
        min_scale_px_(min_scale_px) {}

  bool operator()(const Keypoint& keypoint) const {
    const Eigen::Vector2d place = linear_ * PositionOf(keypoint) + scene_from_template_.translation;
    return keypoint.scale_px * scene_from_template_.scale >= min_scale_px_ && searched_.Contains(place.x(), place.y());
  }

 private:
  const Similarity2& scene_from_template_;
  Eigen::Matrix2d linear_;
  Box searched_;
  double min_scale_px_;
};

// The fraction of scene keypoints that agree with the projection of a template keypoint in position, scale and
// orientation: p for rank 1. Counted over windows twice as wide, since narrow windows hold few keypoints or none, and
// then reduced by the ratio of the windows.
class AgreeingFraction {
 public:
  /// @param inliers  of the pose: the template keypoints that are asked for
  AgreeingFraction(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                   const PoseWindow& window, const FeatureSet& scene, std::span<const Keypoint> model,
                   const VoteOptions& options)
      : scene_from_template_(scene_from_template),
        linear_(scene_from_template.Linear()),
        reach_px_(kCountingFactor * window.widest_px),
        turn_window_rad_(std::min(kPi, options.turn_rad)),
        wide_turn_rad_(std::min(kPi, kCountingFactor * turn_window_rad_)),
        wider_(reach_px_ / window.radius_px * (reach_px_ / window.radius_px) * wide_turn_rad_ / turn_window_rad_),
        scene_size_(scene.size()) {
    CollectAround(inliers, scene, model);
  }

  double operator()(const Keypoint& keypoint) {
    const Eigen::Vector2d place = linear_ * PositionOf(keypoint) + scene_from_template_.translation;
    const double scale_px = keypoint.scale_px * scene_from_template_.scale;
    const double turn_rad = keypoint.orientation_rad + scene_from_template_.rotation_rad;
    constexpr double kRounding_px = 0.1;  // of single precision, for coordinates up to 10^5 px
    const double reach_px = reach_px_ + kRounding_px;
    const std::size_t near =
        kernels::FindAgreeingPairs({x_.data(), y_.data(), x_.data(), y_.data()}, 0, around_.size(),
                                   {.shift_x = static_cast<float>(place.x()), .shift_y = static_cast<float>(place.y())},
                                   static_cast<float>(reach_px * reach_px), near_.data(), error2_px2_.data());
    int count = 0;
    for (const std::uint32_t i : std::span(near_).first(near)) {
      const Keypoint& other = around_[i];
      if ((PositionOf(other) - place).squaredNorm() > reach_px_ * reach_px_) continue;
      if (other.scale_px > kVoteScaleFactor * scale_px || other.scale_px * kVoteScaleFactor < scale_px) continue;
      const double difference_rad = other.orientation_rad - turn_rad;
      const double turn_between_rad =
          std::abs(std::abs(difference_rad) <= kPi ? difference_rad : WrapAngle(difference_rad));
      if (turn_between_rad > wide_turn_rad_) continue;
      ++count;
    }
    return std::max(kMinAgreeingCount, count / wider_) / static_cast<double>(scene_size_);
  }

 private:
  // The scene keypoints within reach of the projections of inliers, and some around them: a small part of a scene.
  void CollectAround(std::span<const RankedMatch> inliers, const FeatureSet& scene, std::span<const Keypoint> model) {
    if (!inliers.empty()) {
      Eigen::AlignedBox2d box;
      for (const RankedMatch& match : inliers) {
        box.extend(linear_ * PositionOf(model[match.template_keypoint]) + scene_from_template_.translation);
      }
      // Wider by one pixel than the windows, so that rounding excludes none of their keypoints.
      const auto left = static_cast<float>(box.min().x() - reach_px_ - 1);
      const auto top = static_cast<float>(box.min().y() - reach_px_ - 1);
      const auto right = static_cast<float>(box.max().x() + reach_px_ + 1);
      const auto bottom = static_cast<float>(box.max().y() + reach_px_ + 1);
      for (const Keypoint& keypoint : scene.keypoints) {
        if (keypoint.x < left || keypoint.x > right || keypoint.y < top || keypoint.y > bottom) continue;
        around_.push_back(keypoint);
      }
    }
    const std::size_t padded = around_.size() + kernels::kVotePadding;
    x_.resize(padded);
    y_.resize(padded);
    for (std::size_t i = 0; i < around_.size(); ++i) {
      x_[i] = around_[i].x;
      y_[i] = around_[i].y;
    }
    near_.resize(padded);
    error2_px2_.resize(padded);
  }

  const Similarity2& scene_from_template_;
  Eigen::Matrix2d linear_;
  double reach_px_;  // of the wider window
  double turn_window_rad_;
  double wide_turn_rad_;
  double wider_;  // the counted window over that of an inlier
  std::size_t scene_size_;
  std::vector<Keypoint> around_;
  std::vector<float> x_;  // of around_, padded for kernels
  std::vector<float> y_;
  std::vector<std::uint32_t> near_;  // of FindAgreeingPairs
  std::vector<float> error2_px2_;
};

// True if two scene descriptors belong to a repeated texture.
bool HaveSimilarDescriptors(const FeatureSet& scene, std::size_t a, std::size_t b) {
  if (scene.descriptors.empty()) return false;  // positions only
  const auto of_a = scene.View().Descriptor(a);
  const auto of_b = scene.View().Descriptor(b);
  int squared = 0;
  for (std::size_t i = 0; i < kDescriptorSize; ++i) squared += (of_a[i] - of_b[i]) * (of_a[i] - of_b[i]);
  return squared < kMaxSimilarDistance * kMaxSimilarDistance;
}

// The chance p of each independent inlier, ascending. Omits an inlier that overlaps one of lower rank in the scene or
// has a similar descriptor: false matches on a repeated texture, the joints of a pavement for example, come together.
std::vector<double> InlierChances(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                                  const PoseWindow& window, const FeatureSet& scene, std::span<const Keypoint> model,
                                  const VoteOptions& options) {
  std::vector<RankedMatch> by_rank(inliers.begin(), inliers.end());
  std::ranges::stable_sort(by_rank, {}, &RankedMatch::rank);
  AgreeingFraction agreeing_fraction(scene_from_template, inliers, window, scene, model, options);
  std::vector<std::size_t> taken;
  std::vector<double> chances;
  for (const RankedMatch& match : by_rank) {
    const Keypoint& keypoint = scene.keypoints[match.scene_keypoint];
    const bool is_dependent = std::ranges::any_of(taken, [&](std::size_t known) {
      const Keypoint& other = scene.keypoints[known];
      const double reach_px = options.min_separation_scales * std::max(keypoint.scale_px, other.scale_px);
      return (PositionOf(keypoint) - PositionOf(other)).norm() < reach_px ||
             HaveSimilarDescriptors(scene, match.scene_keypoint, known);
    });
    if (is_dependent) continue;
    taken.push_back(match.scene_keypoint);
    chances.push_back(std::min(1.0, match.rank * agreeing_fraction(model[match.template_keypoint])));
  }
  std::ranges::sort(chances);
  return chances;
}

}  // namespace

double Log10PoseCount(const Similarity2& scene_from_template, double radius_px, double size_px,
                      const FeatureSet& scene) {
  const double windows = scene.SearchedBox().Area() / (kPi * radius_px * radius_px);
  const double rim = std::max(1.0, 0.5 * size_px * scene_from_template.scale / radius_px);
  const double octaves = kScaleRangeOctaves * std::log(2.0);
  return std::log10(std::max(1.0, windows)) + std::log10(2 * kPi * rim) + std::log10(octaves * rim);
}

double ComputeRankNegLog10Nfa(const Similarity2& scene_from_template, std::span<const RankedMatch> inliers,
                              const PoseWindow& window, double size_px, const FeatureSet& scene,
                              std::span<const Keypoint> model, const VoteOptions& options) {
  const std::vector<double> chances = InlierChances(scene_from_template, inliers, window, scene, model, options);
  const Visibility visible(scene_from_template, scene, kMinVisibleScale_px);
  // The windows admit inliers slightly outside the frame or slightly too small. They count in n, so that k <= n.
  const auto expected = std::ranges::count_if(model, visible);
  const auto unexpected = std::ranges::count_if(
      inliers, [&](const RankedMatch& match) { return !visible(model[match.template_keypoint]); });
  const auto n = static_cast<double>(expected + unexpected);
  double min_log = 0;  // of C(n, k) p_k^k
  for (std::size_t i = 0; i < chances.size(); ++i) {
    const double k = static_cast<double>(i + 1);
    min_log = std::min(min_log, LogChoose(n, k) + k * std::log(chances[i]));
  }
  return -min_log / std::log(10.0) - Log10PoseCount(scene_from_template, window.radius_px, size_px, scene) -
         kDependenceDecades;
}

}  // namespace victorious
