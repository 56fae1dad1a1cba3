// Which matches are right, by geometry alone. A template keypoint's place on the object, as the rendering's depth gives
// it, goes through the true pose of an object of that kind into the picture; a match is true if its scene keypoint lies
// there and that place is not hidden. Within a few more pixels it is neither: the same edge, not the same point. What a
// match's neighbours are, or any map fitted to matches, has no say.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/evaluate/experiments/known_scene.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

enum class Truth { kRight, kNear, kWrong };

/// How many matches there are, and how many of them are right, or nearly.
struct MatchCount {
  int matches = 0;
  int right = 0;
  int near = 0;

  [[nodiscard]] int Wrong() const { return matches - right - near; }
  MatchCount& operator+=(const MatchCount& other) {
    matches += other.matches;
    right += other.right;
    near += other.near;
    return *this;
  }
};

/// One template in one scene.
class MatchTruth {
 public:
  /// How far from its place a true match may lie: keypoints of larger scale are placed less exactly.
  static constexpr double kLeastTolerancePx = 3;
  static constexpr double kToleranceScales = 1;
  static constexpr double kNearPx = 10;  ///< beyond it, and its tolerance, a match is wrong
  /// A point is hidden if the nearest surface is nearer than it by more than this share of the object's size.
  static constexpr double kSameSurfaceShare = 0.02;

  /// @param kind    of the objects that the template shows
  /// @param points  the template keypoints' places on the object, metres
  /// @param size_m  the diagonal of such an object's bounding box
  MatchTruth(const KnownScene& scene, std::string_view kind, std::span<const Point3> points, double size_m);

  [[nodiscard]] Truth Of(const Keypoint& scene, std::uint32_t model) const;
  [[nodiscard]] MatchCount Count(std::span<const Keypoint> scene, const MatchSet& matches) const;

 private:
  std::size_t points_ = 0;
  std::vector<std::optional<Eigen::Vector2d>> places_;  ///< px, of each object all points; none: hidden or out of view
};

}  // namespace victorious
