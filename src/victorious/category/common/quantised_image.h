// An image as quantised features: keypoints, each with the visual words that it is assigned to.
// Soft assignment: J. Philbin et al., "Lost in quantization", CVPR 2008.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "victorious/category/common/vocabulary.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Soft assignment of a keypoint to a word.
struct WordAssignment {
  std::uint32_t word = 0;  ///< index in the vocabulary
  float weight = 1;        ///< weight of the assignment, 0 to 1
};

/// Quantised features of an image, or of a crop.
struct QuantisedImage {
  std::vector<Keypoint> keypoints;
  std::size_t words_per_keypoint = 1;  ///< words per keypoint
  std::vector<WordAssignment>
      assignments;         ///< `words_per_keypoint` per keypoint, nearest first; their weights sum to 1
  Eigen::VectorXf fisher;  ///< Fisher vector (fisher.h); empty if the model has no encoder
  Eigen::VectorXf shape;   ///< shape vector (shape.h); empty if the model has no encoder
  int width = 0;           ///< px
  int height = 0;          ///< px

  [[nodiscard]] std::size_t size() const { return keypoints.size(); }
  /// The word assignments of keypoint i.
  [[nodiscard]] std::span<const WordAssignment> Assignments(std::size_t i) const {
    return std::span(assignments).subspan(i * words_per_keypoint, words_per_keypoint);
  }
  /// The nearest word of keypoint i.
  [[nodiscard]] std::uint32_t NearestWord(std::size_t i) const { return assignments[i * words_per_keypoint].word; }
};

/// Sigma of the soft assignment, in descriptor distance (descriptors have length 512): a word farther than the nearest
/// by sigma has exp(-1/2) of its weight.
inline constexpr double kAssignmentSigma = 50.0;

/// Assigns each keypoint to its nearest words, with weights proportional to exp(-(d^2 - d_nearest^2) / (2 sigma^2)) of
/// the descriptor distance d.
/// @param words_per_keypoint  words per keypoint, 1 to 8; clamped to the vocabulary's size
QuantisedImage QuantiseFeatures(const FeatureSet& features, const Vocabulary& vocabulary, int words_per_keypoint);

}  // namespace victorious
