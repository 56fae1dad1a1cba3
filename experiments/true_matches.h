// Labels matches as true or false by geometry only, independently of neighbouring matches and of fitted maps.
//
// Method: the 3-D point of a template keypoint, from the rendering's depth, is projected with the true pose of each
// object of the model. A match is true if its scene keypoint lies within max(3 px, its scale) of a projection that is
// not occluded, and false beyond 10 px. Between these it is near, which counts as neither: typically the same edge, but
// not the same point.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "experiments/known_scene.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"
#include "victorious/types/object_model.h"

namespace victorious {

enum class MatchLabel { kTrue, kNear, kFalse };

/// Number of matches, and of true and near ones among them.
struct MatchCount {
  int matches = 0;
  int correct = 0;
  int near = 0;

  [[nodiscard]] int FalseMatches() const { return matches - correct - near; }
  MatchCount& operator+=(const MatchCount& other) {
    matches += other.matches;
    correct += other.correct;
    near += other.near;
    return *this;
  }
};

/// Labels the matches of one template in one scene.
class MatchTruth {
 public:
  /// Tolerance of a true match: the larger of a distance and a multiple of the keypoint's scale, because keypoints of
  /// larger scale are localised less accurately.
  static constexpr double kMinTolerancePx = 3;
  static constexpr double kToleranceScales = 1;
  static constexpr double kNearPx = 10;  ///< a match beyond this distance and the tolerance is false
  /// A point is occluded if the nearest surface is nearer by more than this fraction of the object's size.
  static constexpr double kSameSurfaceFraction = 0.02;

  /// @param kind    name of the template's model
  /// @param points  3-D points of the template keypoints in the model frame, metres
  /// @param size_m  diagonal of the model's bounding box
  MatchTruth(const AnnotatedImage& scene, std::string_view kind, std::span<const Point3> points, double size_m);

  /// @param scene  the scene keypoint
  /// @param model  index of the template keypoint
  [[nodiscard]] MatchLabel Label(const Keypoint& scene, std::uint32_t model) const;
  [[nodiscard]] MatchCount Count(std::span<const Keypoint> scene, const MatchSet& matches) const;

 private:
  std::size_t points_ = 0;
  std::vector<std::optional<Eigen::Vector2d>> projections_;  ///< px, all points of each object; nullopt: not visible
};

}  // namespace victorious
