#include "victorious/category/common/quantised_image.h"

#include <algorithm>
#include <cmath>

namespace victorious {

QuantisedImage QuantiseFeatures(const FeatureSet& features, const Vocabulary& vocabulary, int words_per_keypoint) {
  QuantisedImage image;
  image.keypoints = features.keypoints;
  image.words_per_keypoint = std::min(static_cast<std::size_t>(words_per_keypoint), vocabulary.size());
  image.width = features.image_width;
  image.height = features.image_height;
  const auto nearest = vocabulary.NearestWords(features.descriptors, image.words_per_keypoint);
  image.assignments.reserve(nearest.size());
  for (std::size_t first = 0; first < nearest.size(); first += image.words_per_keypoint) {
    double sum = 0;
    for (std::size_t k = first; k < first + image.words_per_keypoint; ++k) {
      const double farther2 = static_cast<double>(nearest[k].distance2) - nearest[first].distance2;
      const double weight = std::exp(-farther2 / (2 * kAssignmentSigma * kAssignmentSigma));
      sum += weight;
      image.assignments.push_back({nearest[k].index, static_cast<float>(weight)});
    }
    for (std::size_t k = first; k < first + image.words_per_keypoint; ++k)
      image.assignments[k].weight = static_cast<float>(image.assignments[k].weight / sum);
  }
  return image;
}

}  // namespace victorious
