// recognize/, a scene's features prepared for matching: packed once, shared by the searches of all models.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

#include "victorious/geometry/vertical.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/search/match/ranked_matcher.h"
#include "victorious/search/match/upright_matcher.h"
#include "victorious/search/pose/pose_proposal.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Packs the descriptors at the first use, since each method packs them in its own way. Thread-safe.
class PreparedScene {
 public:
  /// @param features  must outlive this
  /// @param vertical  in the camera frame; nullopt: unknown
  /// @param device    of ranked_matcher(); null: the processor. Must outlive this
  explicit PreparedScene(const FeatureSet& features, const std::optional<Vertical>& vertical = {},
                         kernels::NearestDevice* device = nullptr)
      : features_(features), vertical_(vertical), device_(device) {}
  PreparedScene(const PreparedScene&) = delete;
  PreparedScene& operator=(const PreparedScene&) = delete;

  [[nodiscard]] const FeatureSet& features() const { return features_; }
  [[nodiscard]] const std::optional<Vertical>& vertical() const { return vertical_; }

  /// For the ratio test, which compares each scene keypoint with all template keypoints.
  [[nodiscard]] const kernels::PackedQueries& queries() const {
    std::call_once(queries_once_, [&] { queries_ = kernels::PackQueries(features_.View().descriptors); });
    return *queries_;
  }

  /// For ranked matches, which compare each template keypoint with all scene keypoints.
  [[nodiscard]] const RankedMatcher& ranked_matcher() const {
    std::call_once(ranked_once_, [&] { ranked_matcher_.emplace(features_.View(), device_); });
    return *ranked_matcher_;
  }

  /// For proposals, which compare each template keypoint with the scene keypoints of allowed orientation.
  [[nodiscard]] const UprightMatcher& upright_matcher() const {
    std::call_once(upright_once_, [&] {
      std::vector<float> lean_rad;
      lean_rad.reserve(features_.size());
      for (const Keypoint& keypoint : features_.keypoints) {
        lean_rad.push_back(vertical_ ? static_cast<float>(vertical_->LeanAt({keypoint.x, keypoint.y})) : 0.0F);
      }
      upright_matcher_.emplace(features_.View(), lean_rad);
    });
    return *upright_matcher_;
  }

  /// For the significance of proposals.
  [[nodiscard]] const KeypointDensity& density() const {
    std::call_once(density_once_, [&] { density_.emplace(features_); });
    return *density_;
  }

 private:
  const FeatureSet& features_;
  std::optional<Vertical> vertical_;
  kernels::NearestDevice* device_;
  mutable std::once_flag queries_once_;
  mutable std::optional<kernels::PackedQueries> queries_;
  mutable std::once_flag ranked_once_;
  mutable std::optional<RankedMatcher> ranked_matcher_;
  mutable std::once_flag upright_once_;
  mutable std::optional<UprightMatcher> upright_matcher_;
  mutable std::once_flag density_once_;
  mutable std::optional<KeypointDensity> density_;
};

}  // namespace victorious
