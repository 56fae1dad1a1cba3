// An image as quantised features: keypoints, each with the visual words that it is assigned to.
// Soft assignment: J. Philbin et al., "Lost in quantization", CVPR 2008.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/category/vocabulary.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Soft assignment of a keypoint to a word.
struct WordShare {
  std::uint32_t word = 0;  ///< index in the vocabulary
  float share = 1;         ///< weight of the assignment, 0 to 1
};

/// Quantised features of an image, or of a crop.
struct WordedPicture {
  std::vector<Keypoint> keypoints;
  std::size_t few = 1;            ///< words per keypoint
  std::vector<WordShare> shares;  ///< `words_per_keypoint` per keypoint, nearest first; their weights sum to 1
  Eigen::VectorXf fisher;         ///< Fisher vector (fisher.h); empty if the model has no encoder
  Eigen::VectorXf shape;          ///< shape vector (shape.h); empty if the model has no encoder
  int width = 0;                  ///< px
  int height = 0;                 ///< px

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  /// The word assignments of keypoint i.
  [[nodiscard]] std::span<const WordShare> Shares(std::size_t i) const {
    return std::span(shares).subspan(i * few, few);
  }
  /// The nearest word of keypoint i.
  [[nodiscard]] std::uint32_t Word(std::size_t i) const { return shares[i * few].word; }
};

/// Assigns each keypoint to its nearest words, with weights proportional to exp(-(d^2 - d_nearest^2) / (2 sigma^2)) of
/// the descriptor distance d.
/// @param few       words per keypoint, 1 to 8; clamped to the vocabulary's size
/// @param softness  sigma of the weights, in descriptor distance (descriptors have length 512)
WordedPicture WordsOf(const FeatureSet& features, const Vocabulary& vocabulary, int few, double softness);

}  // namespace victorious
