#include "victorious/category/common/quantised_image.h"

#include <algorithm>
#include <cmath>

namespace victorious {

QuantisedImage QuantiseFeatures(const FeatureSet& features, const Vocabulary& vocabulary, int words_per_keypoint) {
  QuantisedImage picture;
  picture.keypoints = features.keypoints;
  picture.words_per_keypoint = std::min(static_cast<std::size_t>(words_per_keypoint), vocabulary.size());
  picture.width = features.image_width;
  picture.height = features.image_height;
  const auto nearest = vocabulary.NearestWords(features.descriptors, picture.words_per_keypoint);
  picture.assignments.reserve(nearest.size());
  for (std::size_t first = 0; first < nearest.size(); first += picture.words_per_keypoint) {
    double sum = 0;
    for (std::size_t k = first; k < first + picture.words_per_keypoint; ++k) {
      const double farther2 = static_cast<double>(nearest[k].distance2) - nearest[first].distance2;
      const double weight = std::exp(-farther2 / (2 * kAssignmentSigma * kAssignmentSigma));
      sum += weight;
      picture.assignments.push_back({nearest[k].index, static_cast<float>(weight)});
    }
    for (std::size_t k = first; k < first + picture.words_per_keypoint; ++k)
      picture.assignments[k].weight = static_cast<float>(picture.assignments[k].weight / sum);
  }
  return picture;
}

}  // namespace victorious
