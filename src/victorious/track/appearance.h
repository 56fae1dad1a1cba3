// track/: the appearance model of a box target. It stores templates of the object from confident frames and scores a
// candidate box by its best match.
//
// A template is the vector of all cell channels (cell_features.h) of the box, each channel minus its mean, scaled to
// norm 1. The score of two templates is their dot product: the NCC of the cell features.
// Source: the template memory of Z. Kalal, K. Mikolajczyk, J. Matas, "Tracking-learning-detection", PAMI 34(7), 2012.
#pragma once

#include <deque>

#include <opencv2/core/mat.hpp>

#include "victorious/track/cut_out.h"

namespace victorious {

class Appearance {
 public:
  /// Stores the first template, which is never discarded.
  /// @param box  the user box, px
  Appearance(const ImagePyramid& image, const RotatedBox& box);

  /// @return the NCC of the box with the best matching stored template, -1 to 1
  [[nodiscard]] double NccScore(const ImagePyramid& image, const RotatedBox& box) const;

  /// Adds a template of the box, unless its NCC with a stored template is 0.9 or more. Beyond 24 templates the oldest
  /// except the first is discarded.
  void AddTemplate(const ImagePyramid& image, const RotatedBox& box);

 private:
  [[nodiscard]] cv::Mat MakeTemplate(const ImagePyramid& image, const RotatedBox& box) const;

  cv::Size template_px_;
  std::deque<cv::Mat> templates_;  // the first is of the user box
};

}  // namespace victorious
