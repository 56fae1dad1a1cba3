// The visual vocabulary: words are cluster centres of descriptors (thesis, sections 2.1.2 and 3.6.2); each descriptor
// of an image is assigned to its nearest word or its k nearest words.
// Method: Lloyd's k-means on a sample, with exact nearest neighbours (kernels/nearest.h: cheaper here than any tree).
// RootSIFT: R. Arandjelovic and A. Zisserman, "Three things everyone should know to improve object retrieval", CVPR
// 2012.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/kernels/nearest.h"
#include "victorious/types/feature_set.h"

namespace victorious {

struct VocabularyOptions {
  int words = 3000;
  bool root = true;
  int iterations = 12;
  int samples =
      60000;  ///< descriptors sampled for k-means, by seed: 20 a word; tests sample fewer. Not a user parameter
  int words_per_keypoint = 4;  ///< nearest words that a keypoint is assigned to, 1 to 8; thesis: 1

  /// Without words_per_keypoint, which CategoryOptions lists outside this group.
  void ListFields(FieldList& fields);
};

class Vocabulary {
 public:
  Vocabulary() = default;
  /// @param centres  128 bytes per word, in the space of comparison: square-rooted if `root`
  /// @param root     true if descriptors are compared as RootSIFT
  Vocabulary(std::vector<std::uint8_t> centres, bool root);

  /// Learns the words by k-means.
  /// @param descriptors  128 bytes each, as computed by features/; at least one
  /// The number of words is at most the number of descriptors. Deterministic for a given seed, independent of the
  /// number of threads.
  static Vocabulary Learn(std::span<const std::uint8_t> descriptors, const VocabularyOptions& options,
                          std::uint64_t seed);

  /// Learns the words from the descriptors of all `sets`.
  static Vocabulary Learn(std::span<const FeatureSet* const> sets, const VocabularyOptions& options,
                          std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return packed_.count; }
  [[nodiscard]] bool root() const { return root_; }
  [[nodiscard]] std::span<const std::uint8_t> centres() const { return centres_; }

  /// Returns the k nearest words of each descriptor, nearest first: k entries per descriptor, 1 <= k <= 8.
  [[nodiscard]] std::vector<kernels::Neighbour> NearestWords(std::span<const std::uint8_t> descriptors,
                                                             std::size_t k) const;

 private:
  std::vector<std::uint8_t> centres_;
  bool root_ = false;
  kernels::PackedDescriptors packed_;
};

/// RootSIFT in bytes: min(255, 512 sqrt(value / sum of the descriptor)), rounded.
std::vector<std::uint8_t> RootDescriptors(std::span<const std::uint8_t> descriptors);

}  // namespace victorious
