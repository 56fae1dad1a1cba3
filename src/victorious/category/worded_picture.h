// A picture as a category sees it: keypoints, each with the words of the vocabulary that it looks most like.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/category/vocabulary.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// How many of a keypoint's descriptor belongs to a word.
struct WordShare {
  std::uint32_t word = 0;
  float share = 1;
};

struct WordedPicture {
  std::vector<Keypoint> keypoints;
  std::size_t few = 1;            ///< words a keypoint
  std::vector<WordShare> shares;  ///< `few` a keypoint, the nearest word first; of each keypoint they sum to 1
  Eigen::VectorXf fisher;         ///< empty, unless a model that has an encoder (fisher.h) made the picture
  Eigen::VectorXf shape;          ///< the same of shapes (shape.h)
  int width = 0;                  ///< px
  int height = 0;                 ///< px

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  [[nodiscard]] std::span<const WordShare> Shares(std::size_t i) const {
    return std::span(shares).subspan(i * few, few);
  }
  /// The nearest word of keypoint i.
  [[nodiscard]] std::uint32_t Word(std::size_t i) const { return shares[i * few].word; }
};

/// @param few            words a keypoint, 1 to 8; at most the vocabulary's size
/// @param softness       how much farther than the nearest word (as a distance of descriptors) a word may be and still
///                       get exp(-1/2) of its share; the larger, the more even
WordedPicture WordsOf(const FeatureSet& features, const Vocabulary& vocabulary, int few, double softness);

}  // namespace victorious
