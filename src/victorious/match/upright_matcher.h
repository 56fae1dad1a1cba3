// match/, from template to scene, for proposals: as RankedMatcher, but only among the scene keypoints that an upright
// object allows, and by shortened descriptors first. With a known camera attitude an upright object allows a sixth of
// all in-plane rotations; a match outside of them cannot vote, so its pair of descriptors need not be compared.
//
// The scene is packed by orientation relative to the vertical's image at each keypoint, so that the allowed rotations
// of a template keypoint are one range of blocks. The keypoints of all templates are matched together, sorted by
// orientation: eight neighbours share a range that is hardly wider than one's own. In the range the nearest four by
// shortened descriptors (kernels/shorten.h) are found, and of them the nearest k by whole descriptors: 89 % of the
// nearest are among them (docs/adr/0018). Orientations are sorted into bins, in linear time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/kernels/nearest.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// A template with its shortened descriptors. Non-owning.
struct UprightTemplate {
  FeatureView features;
  std::span<const std::int8_t> shortened;  ///< kernels::ShortenToQueries of its descriptors
};

/// A scene packed by orientation, matched with any number of templates. Thread-safe.
class UprightMatcher {
 public:
  /// @param scene     its memory must outlive this
  /// @param lean_rad  for each keypoint: the angle of the vertical's image there (Vertical::LeanAt); 0 if unknown
  UprightMatcher(const FeatureView& scene, std::span<const float> lean_rad);

  /// For each template the matches with scene keypoints whose orientation exceeds the template keypoint's by at most
  /// max_turn_rad more or less than the lean there.
  /// @param nearest  k, the maximum number of scene keypoints per template keypoint, 1 to 4
  /// @return in the order of the templates; sorted by template keypoint, then by rank, which counts compared keypoints
  ///         only. Fewer than k where fewer are allowed.
  /// Cost: 8-bit products: keypoints x scene x (fraction of allowed rotations) x 32.
  [[nodiscard]] std::vector<std::vector<RankedMatch>> Match(std::span<const UprightTemplate> templates,
                                                            double max_turn_rad, int nearest) const;

 private:
  [[nodiscard]] kernels::BlockRange BlocksOf(float first_rad, float last_rad, float max_turn_rad) const;

  FeatureView scene_;
  std::vector<float> relative_rad_;       // orientation minus lean, in [-pi, pi], of scene_'s keypoints
  std::vector<std::uint32_t> order_;      // indices into scene_ by rising relative_rad_
  kernels::PackedDescriptors shortened_;  // in that order, padded to whole blocks, twice: ranges may pass pi
  std::vector<float> packed_rad_;         // relative orientation of each packed row, rising from -pi to 3 pi
};

}  // namespace victorious
