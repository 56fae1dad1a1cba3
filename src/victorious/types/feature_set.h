// Keypoints and descriptors of one image.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/geometry/box.h"
#include "victorious/kernels/descriptor.h"

namespace victorious {

/// SIFT (Lowe 2004): 4 x 4 cells of 8 orientation bins, cells row-major; each element 0..255 (the unit vector, clipped
/// at 0.2, times 512).
inline constexpr std::size_t kDescriptorSize = kernels::kDescriptorBytes;

/// Position, scale and orientation. Model files and indexes store these bytes unchanged: never reorder the fields.
struct Keypoint {
  float x = 0;                ///< px, to the right; the first pixel's centre is at 0.5
  float y = 0;                ///< px, down
  float scale_px = 1;         ///< sigma of the detection Gaussian, in pixels of the input image
  float orientation_rad = 0;  ///< [-pi, pi], from +x towards +y (down)

  bool operator==(const Keypoint&) const = default;
};
static_assert(sizeof(Keypoint) == 16);

/// False if no image can produce this keypoint. Validates keypoints that are read from files before a search.
inline bool IsUsable(const Keypoint& keypoint) {
  constexpr float kFarthest_px = 1e6F;
  return std::abs(keypoint.x) < kFarthest_px && std::abs(keypoint.y) < kFarthest_px && keypoint.scale_px > 0 &&
         keypoint.scale_px < kFarthest_px && std::isfinite(keypoint.orientation_rad);
}

/// Non-owning view of keypoints and descriptors: keypoint i has descriptors[128 i, 128 (i + 1)).
struct FeatureView {
  std::span<const Keypoint> keypoints;
  std::span<const std::uint8_t> descriptors;

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  [[nodiscard]] std::span<const std::uint8_t> Descriptor(std::size_t i) const {
    return descriptors.subspan(i * kDescriptorSize, kDescriptorSize);
  }
  [[nodiscard]] FeatureView Slice(std::size_t first, std::size_t count) const {
    return {keypoints.subspan(first, count), descriptors.subspan(first * kDescriptorSize, count * kDescriptorSize)};
  }
};

struct FeatureSet {
  std::vector<Keypoint> keypoints;
  std::vector<std::uint8_t> descriptors;  ///< 128 bytes per keypoint
  int image_width = 0;                    ///< px
  int image_height = 0;                   ///< px
  std::optional<Box> part;                ///< region of interest that was searched, px; nullopt: the whole image

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  [[nodiscard]] FeatureView View() const { return {keypoints, descriptors}; }
  /// The searched region, px.
  [[nodiscard]] Box SearchedBox() const { return part.value_or(FrameBox(image_width, image_height)); }
};

}  // namespace victorious
