// What the linear classifier sees of a picture: how often each word occurs, and how often each phrase.
//
// A phrase is two words at a certain place to each other, the thesis's idea in the form of counts. For counts to repeat
// between pictures, words that look alike share a part (a cluster of words), and the geometric measures are coarse: the
// two keypoints are of one size (scale ratio), near or far in units of that size (scale to distance), in one of four
// directions to their mean orientation (theta_b), and of like orientation (theta_a). Counts are compared by their
// square roots, at unit length (Hellinger kernel): what repeats within a picture says little more than the first time,
// and large pictures count as small ones.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "victorious/base/options.h"
#include "victorious/category/worded_picture.h"

namespace victorious {

struct PhraseOptions {
  int parts = 128;
  double nearest_cells = 1.5;
  double far_cells = 2.75;
  double farthest_cells = 4.0;
  double weight = 2.5;

  void ListFields(FieldList& fields);
};

/// A sparse vector: entries by rising index.
using SparseVector = std::vector<std::pair<std::uint32_t, float>>;

double Dot(const SparseVector& a, const SparseVector& b);

/// How often each word occurs (soft shares summed).
SparseVector CountWords(const WordedPicture& picture, std::size_t words);

/// Counts to what is compared: square roots, at unit length.
SparseVector Hellinger(SparseVector counts);

/// A phrase's occurrence in a picture: two keypoints, and which phrase.
struct PhraseOccurrence {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
  std::uint32_t phrase = 0;
};

inline constexpr std::size_t kPlacesOfPhrase = 8;  ///< 4 directions, near and far

/// parts^2 x kPlacesOfPhrase.
std::size_t PhraseCount(std::size_t parts);

/// Every phrase of a picture. A keypoint's part is that of its nearest word.
/// @param part_of_word  below `parts`
/// Cost: the pairs of keypoints of one size within farthest_cells of it.
std::vector<PhraseOccurrence> FindPhrases(const WordedPicture& picture, std::span<const std::uint16_t> part_of_word,
                                          std::size_t parts, const PhraseOptions& options);

SparseVector CountPhrases(std::span<const PhraseOccurrence> phrases, std::size_t parts);

}  // namespace victorious
