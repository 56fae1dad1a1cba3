// track/, how the object has looked so far: to tell whether what was found is the object.
// Source: the idea of a memory of sure looks is that of Z. Kalal, K. Mikolajczyk, J. Matas, "Tracking-learning-
// detection", PAMI 34(7), 2012.
#pragma once

#include <deque>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cut_out.h"

namespace victorious {

class Appearance {
 public:
  /// @param box  of the object as drawn, px: its look there is never forgotten
  Appearance(const Levels& image, const TurnedBox& box);

  /// How much the box's content is like the likest look of the object, -1 to 1.
  [[nodiscard]] double Likeness(const Levels& image, const TurnedBox& box) const;

  /// Keeps a look of the object, unless it adds nothing.
  void Remember(const Levels& image, const TurnedBox& box);

 private:
  [[nodiscard]] cv::Mat Look(const Levels& image, const TurnedBox& box) const;

  cv::Size look_px_;
  std::deque<cv::Mat> looks_;  // the first is the drawn one
};

}  // namespace victorious
