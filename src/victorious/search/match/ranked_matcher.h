// match/, from template to scene: for each template keypoint the k nearest scene keypoints, without a ratio test. For
// objects of little texture in cluttered scenes the true match is often among the k nearest of thousands but fails the
// ratio test. The vote search (search/pose/vote_poses.h) finds the true ones. Measurements: docs/adr/0008.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "victorious/kernels/nearest.h"
#include "victorious/kernels/nearest_device.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// A scene with packed descriptors, matched with any number of templates. Thread-safe.
class RankedMatcher {
 public:
  /// @param device  computes the distances of MatchAll; null: the processor does. Must outlive this
  explicit RankedMatcher(const FeatureView& scene, kernels::NearestDevice* device = nullptr)
      : scene_(kernels::Pack(scene.descriptors)), device_(device) {}

  /// @param model    a template's descriptors
  /// @param nearest  k, the number of scene keypoints per template keypoint, 1 to kernels::kMaxNeighbours
  /// @return sorted by template keypoint, then by rank; empty if the scene has no more than `nearest` keypoints
  /// Cost: that of MatchFeatures().
  [[nodiscard]] std::vector<RankedMatch> Match(const kernels::PackedQueries& model, int nearest) const;

  /// Match() of each template, in one call of the device: the same matches. If the device fails, the processor
  /// computes them.
  [[nodiscard]] std::vector<std::vector<RankedMatch>> MatchAll(std::span<const kernels::PackedQueries> templates,
                                                               int nearest) const;

 private:
  // The neighbours of all templates' keypoints; std::nullopt: the device failed.
  [[nodiscard]] std::optional<std::vector<kernels::Neighbour>> FindOnDevice(
      std::span<const kernels::PackedQueries> templates, std::size_t nearest) const;

  kernels::PackedDescriptors scene_;
  kernels::NearestDevice* device_;
  mutable std::once_flag uploaded_;
  mutable std::unique_ptr<const kernels::DeviceSet> scene_on_device_;  // null: failed
};

}  // namespace victorious
