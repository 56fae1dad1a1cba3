// The channels of an image (P. Dollár et al., "Fast feature pyramids for object detection", PAMI 2014): luma, two
// chromas, and the magnitude of the gradient in all and in each of 8 orientations, as bytes on a grid of cells.
//
//   base cells: sums over 2 x 2 px; gradients are divided by their mean over 7 x 7 cells
//   level:      base cells resampled to cells of another size; one octave of sizes from the same base cells
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace victorious {

inline constexpr int kOrientationChannels = 8;
inline constexpr int kFirstOrientation = 4;  ///< of luma, red and blue chroma, magnitude
inline constexpr int kChannelCount = kFirstOrientation + kOrientationChannels;
inline constexpr int kBaseCell_px = 2;

/// Planes of cells, one a channel.
struct ChannelPlanes {
  int columns = 0;
  int rows = 0;
  std::ptrdiff_t stride = 0;  ///< bytes from a row to the next
  std::vector<std::uint8_t> bytes;

  /// The bytes are not initialised to anything but 0. kWindowPadding bytes follow the last plane.
  void Resize(int new_columns, int new_rows);

  [[nodiscard]] std::ptrdiff_t plane() const { return stride * rows; }
  [[nodiscard]] std::ptrdiff_t OffsetOf(int channel, int x, int y) const { return channel * plane() + y * stride + x; }
  /// The plane as an image of the same bytes.
  [[nodiscard]] cv::Mat Plane(int channel);
  [[nodiscard]] cv::Mat Plane(int channel) const;
};

/// The image in luma and chromas (YCrCb), CV_8UC3, from one in colour (BGR) or grey.
[[nodiscard]] cv::Mat LumaAndChroma(const cv::Mat& image);

/// The image at half the size, as cells of 2 x 2 px: an odd last row or column is left out.
[[nodiscard]] cv::Mat HalveImage(const cv::Mat& image);

/// The base cells of an image.
/// @param image  by LumaAndChroma, at least 2 x 2 px
/// @param half   by HalveImage: one pixel a cell
[[nodiscard]] ChannelPlanes ComputeChannels(const cv::Mat& image, const cv::Mat& half);

/// Resamples all planes to columns x rows cells, within a border of `border` cells that repeats the outermost ones.
void ResampleChannels(const ChannelPlanes& base, int columns, int rows, int border, ChannelPlanes& level);

}  // namespace victorious
