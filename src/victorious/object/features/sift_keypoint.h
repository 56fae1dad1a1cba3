// The engine `sift`, second stage: extrema of the grid to keypoints with subpixel position, scale and orientations.
// Source: D. Lowe, IJCV 60(2), 2004, sections 4 and 5.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "victorious/kernels/orientation.h"
#include "victorious/object/features/scale_space.h"

namespace victorious {

/// A keypoint of an octave before it has an orientation.
struct RefinedExtremum {
  GridExtremum grid;  ///< the pixel and layer that it was refined at
  float x = 0;        ///< px of the octave, pixel centres at integers
  float y = 0;
  float layer = 0;     ///< with its fraction
  float contrast = 0;  ///< |D| at the refined position, as a fraction of the range of grey

  /// px of the octave
  [[nodiscard]] double Sigma() const;
};

struct RefineOptions {
  double contrast_threshold = 0.04;  ///< as FeatureOptions
  double edge_threshold = 10;
};

/// Fits a quadratic to D around the extremum, moves to the neighbour that its maximum is nearest to, at most five
/// times, and tests contrast and edge response there. The formulas, limits and thresholds are those of cv::SIFT.
/// @return nothing if the fit leaves the octave, does not settle, or a test fails
std::optional<RefinedExtremum> Refine(const OctaveLevels& levels, const GridExtremum& extremum,
                                      const RefineOptions& options);

/// At most this many orientations of a keypoint.
inline constexpr std::size_t kMaxOrientations = 8;

struct Orientations {
  std::array<float, kMaxOrientations> bin{};  ///< with their fractions; a bin is 10 degrees
  std::uint32_t count = 0;
};

/// The peaks of a histogram, smoothed by (1, 4, 6, 4, 1) / 16, that reach 0.8 of its maximum, by parabolas.
Orientations FindPeaks(std::span<const std::int32_t, kernels::kOrientationBins> histogram);

/// The orientation windows of an octave's scales, made once.
class OrientationWindows {
 public:
  OrientationWindows();
  /// @param layer  with its fraction, 0.5 to 3.5; the window of the nearest of 25 scales
  [[nodiscard]] const kernels::OrientationWindow& At(float layer) const;

 private:
  std::array<kernels::OrientationWindow, 25> windows_;
};

}  // namespace victorious
