// Explains a category score: the phrases that contribute to a node's raw score, and their location in the image
// (thesis, section 6.1).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/category/category_model.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// A phrase in an image and its contribution to a node's raw score. By the thesis's method the weight is its
/// fraction of the sum in equation 3.3.
struct PhraseContribution {
  std::uint32_t i = 0;  ///< index of the first keypoint of the image
  std::uint32_t j = 0;  ///< index of the second keypoint
  double weight = 0;    ///< negative: the phrase lowers the score
};

/// Returns all phrases with a non-zero contribution to the node, by decreasing weight.
std::vector<PhraseContribution> ComputeContributions(const CategoryModel& model, const QuantisedImage& image,
                                                     std::size_t node);

/// Localises the category: returns the box (px) that maximises the sum of contributions above the image's mean, on a
/// grid of 32 cells along the longer side (maximum-sum rectangle by Kadane's algorithm). Returns the whole image if the
/// contributions are uniform or empty.
/// Cost: about 0.1 ms plus the accumulation of the contributions.
Box SupportingBox(const std::vector<PhraseContribution>& contributions, const QuantisedImage& image);

/// Draws the phrases with the largest positive contributions (brightness proportional to the weight), the supporting
/// box and a caption on the image. Returns CV_8UC3, at least 480 px wide.
cv::Mat DrawContributions(const cv::Mat& bgr, const QuantisedImage& image,
                          const std::vector<PhraseContribution>& contributions, const std::string& caption);

}  // namespace victorious
