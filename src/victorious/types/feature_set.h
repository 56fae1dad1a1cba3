// Keypoints and their descriptors, of one image.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "victorious/geometry/box.h"

namespace victorious {

/// Lowe's 4 x 4 cells of 8 orientations, rows of cells first; each 0..255 (the unit vector, clipped at 0.2, times 512).
inline constexpr std::size_t kDescriptorSize = 128;

/// A place in an image with a size and a direction. Stored as it stands in model files and indexes: never reorder.
struct Keypoint {
  float x = 0;                ///< px, first pixel's centre at 0.5
  float y = 0;                ///< px, down
  float scale_px = 1;         ///< the Gaussian's sigma, in pixels of the image as given
  float orientation_rad = 0;  ///< [-pi, pi], from +x towards +y (down)

  bool operator==(const Keypoint&) const = default;
};
static_assert(sizeof(Keypoint) == 16);

/// False for what cannot come from an image: outside bytes are checked with it before they are searched.
inline bool IsUsable(const Keypoint& keypoint) {
  constexpr float kFarthest_px = 1e6F;
  return std::abs(keypoint.x) < kFarthest_px && std::abs(keypoint.y) < kFarthest_px && keypoint.scale_px > 0 &&
         keypoint.scale_px < kFarthest_px && std::isfinite(keypoint.orientation_rad);
}

/// A view of keypoints and descriptors that something else owns: keypoint i has descriptors[128 i, 128 (i + 1)).
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
  std::vector<std::uint8_t> descriptors;  ///< 128 a keypoint
  int image_width = 0;                    ///< px
  int image_height = 0;                   ///< px
  std::optional<Box> part;                ///< of the image, which alone was looked at, px; nothing: all of it

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  [[nodiscard]] FeatureView View() const { return {keypoints, descriptors}; }
  [[nodiscard]] Box Searched() const { return part.value_or(FrameBox(image_width, image_height)); }
};

}  // namespace victorious
