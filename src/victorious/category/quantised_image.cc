#include "victorious/category/quantised_image.h"

#include <algorithm>
#include <cmath>

namespace victorious {

WordedPicture WordsOf(const FeatureSet& features, const Vocabulary& vocabulary, int few, double softness) {
  WordedPicture picture;
  picture.keypoints = features.keypoints;
  picture.few = std::min(static_cast<std::size_t>(few), vocabulary.size());
  picture.width = features.image_width;
  picture.height = features.image_height;
  const auto nearest = vocabulary.NearestWords(features.descriptors, picture.few);
  picture.shares.reserve(nearest.size());
  for (std::size_t first = 0; first < nearest.size(); first += picture.few) {
    double sum = 0;
    for (std::size_t k = first; k < first + picture.few; ++k) {
      const double farther2 = static_cast<double>(nearest[k].distance2) - nearest[first].distance2;
      const double share = std::exp(-farther2 / (2 * softness * softness));
      sum += share;
      picture.shares.push_back({nearest[k].index, static_cast<float>(share)});
    }
    for (std::size_t k = first; k < first + picture.few; ++k)
      picture.shares[k].share = static_cast<float>(picture.shares[k].share / sum);
  }
  return picture;
}

}  // namespace victorious
