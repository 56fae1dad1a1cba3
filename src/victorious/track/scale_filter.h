// track/, how large an object has become: a correlation filter over one dimension, whose samples are the object cut out
// at sizes around the last one.
// Source: M. Danelljan, G. Hager, F. Khan, M. Felsberg, "Discriminative scale space tracking", PAMI 39(8), 2017.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cut_out.h"

namespace victorious {

class ScaleFilter {
 public:
  /// @param box  of the object, px: its shape stays
  explicit ScaleFilter(const TurnedBox& box);

  /// Learns the object's look at this size.
  /// @param rate  0 to 1: how much of what was learnt before is forgotten; the first call forgets all
  void Learn(const Levels& image, const TurnedBox& box, double rate);

  /// @return the factor by which `box` must grow for the object to look as learnt
  [[nodiscard]] double Growth(const Levels& image, const TurnedBox& box) const;

 private:
  [[nodiscard]] cv::Mat Samples(const Levels& image, const TurnedBox& box) const;

  cv::Size sample_px_;   // each size is brought to this
  cv::Mat wanted_;       // spectrum of a Gaussian over the sizes: 1 x sizes, complex
  cv::Mat numerator_;    // dimensions x sizes, complex
  cv::Mat denominator_;  // 1 x sizes
};

}  // namespace victorious
