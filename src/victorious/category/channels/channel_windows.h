// Windows of a detector by channels: the levels of an image, what a window of 16 x 16 cells sees, and how it turns.
//
// An object of length L and width W fills sqrt(L W) = kObjectCells cells of its level. Objects seen straight down have
// any heading: 8 of them, modulo 180 degrees, whose windows are turned and mirrored copies of three trained ones.
// With 8 orientations of gradients the copies are exact: features are renamed, no pixel is resampled.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/channels/channel_planes.h"
#include "victorious/geometry/box.h"

namespace victorious {

inline constexpr int kWindowCells = 16;  ///< side of a window
inline constexpr int kObjectCells = 8;   ///< sqrt(length x width) of its object
inline constexpr int kWindowFeatures = kChannelCount * kWindowCells * kWindowCells;
inline constexpr int kLevelBorder = 4;      ///< cells around a level
inline constexpr int kLevelsPerOctave = 3;  ///< sizes of cells: factors of 2^(1/3)
inline constexpr int kHeadings = 8;
inline constexpr int kTrainedHeadings = 3;  ///< 0, 22.5 and 45 degrees

/// The bytes of a window: feature (channel kWindowCells + y) kWindowCells + x.
using WindowFeatures = std::vector<std::uint8_t>;

/// How a heading follows from a trained one: transposed first, then mirrored left to right.
struct HeadingCopy {
  int trained = 0;
  bool is_transposed = false;
  bool is_mirrored = false;
};

/// Of heading h, h 22.5 degrees from the x axis towards the y axis.
inline constexpr std::array<HeadingCopy, kHeadings> kHeadingCopies = {{{0, false, false},
                                                                       {1, false, false},
                                                                       {2, false, false},
                                                                       {1, true, false},
                                                                       {0, true, false},
                                                                       {1, true, true},
                                                                       {2, false, true},
                                                                       {1, false, true}}};

/// The feature of the copy that is `feature` of the trained window.
[[nodiscard]] int CopiedFeature(const HeadingCopy& copy, int feature);

/// The size of the box of an object of this length and width, with this heading.
[[nodiscard]] cv::Size2d BoxOfHeading(double length, double width, double angle_rad);

struct ChannelLevel {
  ChannelPlanes planes;      ///< with a border of kLevelBorder cells
  double cell_width_px = 0;  ///< of the image
  double cell_height_px = 0;

  [[nodiscard]] int WindowColumns() const { return planes.columns - kWindowCells + 1; }
  [[nodiscard]] int WindowRows() const { return planes.rows - kWindowCells + 1; }
  /// The middle of the window at cell (x, y), px of the image.
  [[nodiscard]] cv::Point2d Middle(int x, int y) const;
  /// What the window at cell (x, y) sees, as the trained window of the copy would.
  [[nodiscard]] WindowFeatures Features(int x, int y, const HeadingCopy& copy) const;
};

/// The cells of the finest level of an image, px: as given, or larger, so that a level of a large image stays below 1
/// GB and offsets into it below 2^31.
[[nodiscard]] double FinestCell(const cv::Size& image, double min_cell_px);

/// Calls `use` with each level, from the finest.
/// @param image        BGR or grey, 8 bits
/// @param min_cell_px  size of the cells of the finest level
void ForEachLevel(const cv::Mat& image, double min_cell_px, const std::function<void(const ChannelLevel&)>& use);

/// An image of which windows are cut at any place, size and angle: for training.
class WindowCutter {
 public:
  explicit WindowCutter(const cv::Mat& image);

  /// @param middle    px of the image
  /// @param cell_px   size of a cell
  /// @param turn_rad  by which the image is turned around the middle, from x towards y
  /// @param mirrored  the image is mirrored (y to -y) before it is turned
  [[nodiscard]] WindowFeatures Cut(cv::Point2d middle, double cell_px, double turn_rad, bool mirrored) const;

 private:
  std::vector<cv::Mat> octaves_;
};

}  // namespace victorious
