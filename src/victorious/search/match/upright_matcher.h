// match/, from template to scene, for proposals: as RankedMatcher, but only among the scene keypoints that an upright
// object allows, of these only the ones that are alike, and by shortened descriptors first. With a known camera
// attitude an upright object allows a sixth of all in-plane rotations; a match outside of them cannot vote, so its pair
// of descriptors need not be compared.
//
// Descriptors are partitioned into cells (descriptor_cells.h). Each cell has a list: the quarter of the scene's
// keypoints that is nearest to its centre (of more than 16,384, as of large frames, 4,096), sorted by orientation
// relative to the vertical's image there. A template keypoint is compared with the list of its cell, in the ranges of
// allowed rotations: with some 300 of 6,000 scene keypoints. The nearest four by shortened descriptors
// (kernels/short_nearest.h) are found, and of them the nearest k by whole descriptors, unless these are too different
// to be of one point (docs/adr/0018). A list is made at the first use.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "victorious/kernels/short_nearest.h"
#include "victorious/object/features/descriptor_cells.h"
#include "victorious/types/feature_set.h"
#include "victorious/types/match_set.h"

namespace victorious {

/// A template with its shortened descriptors. Non-owning.
struct UprightTemplate {
  FeatureView features;
  const ShortDescriptors* shortened;  ///< of the features
};

/// A scene sorted by orientation, matched with any number of templates. Thread-safe.
class UprightMatcher {
 public:
  /// @param scene     its memory must outlive this
  /// @param lean_rad  for each keypoint: the angle of the vertical's image there (Vertical::LeanAt); 0 if unknown
  UprightMatcher(const FeatureView& scene, std::span<const float> lean_rad);

  /// For each template the matches with scene keypoints whose orientation exceeds the template keypoint's by at most
  /// max_turn_rad more or less than the lean there.
  /// @param nearest  k, the maximum number of scene keypoints per template keypoint, 1 to 4
  /// @return in the order of the templates; sorted by template keypoint, then by rank, which counts compared keypoints
  ///         only. Fewer than k where fewer are allowed or similar enough.
  /// Cost: 8-bit products: keypoints x scene / 4 x (fraction of allowed rotations) x 32.
  [[nodiscard]] std::vector<std::vector<RankedMatch>> Match(std::span<const UprightTemplate> templates,
                                                            double max_turn_rad, int nearest) const;

 private:
  static constexpr std::size_t kOrientationBins = 128;

  // The scene keypoints that are compared with the template keypoints of a cell, by rising relative_rad_.
  struct CellList {
    std::vector<std::uint32_t> keypoints;  // of scene_
    kernels::ShortSet descriptors;
    std::array<std::uint16_t, kOrientationBins + 1> first;  // in each bin of relative_rad_
  };

  [[nodiscard]] const CellList& ListOf(std::size_t cell) const;
  [[nodiscard]] CellList MakeList(std::size_t cell) const;
  [[nodiscard]] static kernels::QueryBlocks BlocksOf(const CellList& list, float orientation_rad, float max_turn_rad);

  FeatureView scene_;
  std::vector<float> relative_rad_;   // orientation minus lean, in [-pi, pi], of scene_'s keypoints
  std::vector<std::uint32_t> order_;  // indices into scene_ by rising relative_rad_
  std::vector<std::uint8_t> bins_;    // of orientation, in that order
  kernels::ShortSet packed_;          // the shortened descriptors, in that order
  struct Lists {
    std::array<std::once_flag, kDescriptorCells> once;
    std::array<CellList, kDescriptorCells> lists;
  };
  std::unique_ptr<Lists> lists_;  // made when first asked for
};

}  // namespace victorious
