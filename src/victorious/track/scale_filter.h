// track/: the scale change of an object by a one-dimensional correlation filter over scales. Its samples are the HOG
// features of the object, cropped at 17 scales in steps of 1.03 around the last one.
// Source: M. Danelljan, G. Hager, F. Khan, M. Felsberg, "Discriminative scale space tracking", PAMI 39(8), 2017.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cut_out.h"

namespace victorious {

class ScaleFilter {
 public:
  /// @param box  of the object, px; its aspect ratio is kept
  explicit ScaleFilter(const RotatedBox& box);

  /// Updates the filter with the object at this scale.
  /// @param rate  learning rate, 0 to 1; the first call ignores it
  void Update(const ImagePyramid& image, const RotatedBox& box, double rate);

  /// @return the scale factor for `box` at the peak of the response, with sub-step (parabolic) accuracy
  [[nodiscard]] double EstimateScaleChange(const ImagePyramid& image, const RotatedBox& box) const;

 private:
  [[nodiscard]] cv::Mat ExtractSamples(const ImagePyramid& image, const RotatedBox& box) const;

  cv::Size sample_px_;        // each crop is resampled to this size
  cv::Mat desired_spectrum_;  // spectrum of a Gaussian over scales: 1 x scales, complex
  cv::Mat numerator_;         // dimensions x scales, complex
  cv::Mat denominator_;       // 1 x scales
};

}  // namespace victorious
