// The visual vocabulary: words are the centres of clusters of descriptors (thesis, sections 2.1.2 and 3.6.2), and each
// descriptor of a picture is replaced by the nearest word, or the few nearest.
// Method: Lloyd's k-means on a sample, with exact nearest centres (kernels/nearest.h: cheaper here than any tree).
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
  int samples = 60000;

  void ListFields(FieldList& fields);
};

class Vocabulary {
 public:
  Vocabulary() = default;
  /// @param centres  128 bytes a word, as compared: after the root, where `root`
  Vocabulary(std::vector<std::uint8_t> centres, bool root);

  /// @param descriptors  128 bytes each, as features/ makes them; at least one
  /// Fewer different descriptors than words give fewer words. Deterministic by seed, whatever the number of threads.
  static Vocabulary Learn(std::span<const std::uint8_t> descriptors, const VocabularyOptions& options,
                          std::uint64_t seed);

  /// The same from the descriptors of all `sets`.
  static Vocabulary Learn(std::span<const FeatureSet* const> sets, const VocabularyOptions& options,
                          std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return packed_.count; }
  [[nodiscard]] bool root() const { return root_; }
  [[nodiscard]] std::span<const std::uint8_t> centres() const { return centres_; }

  /// The `few` nearest words of each descriptor, nearest first: `few` entries a feature. 1 <= few <= 8.
  [[nodiscard]] std::vector<kernels::Neighbour> NearestWords(std::span<const std::uint8_t> descriptors,
                                                             std::size_t few) const;

 private:
  std::vector<std::uint8_t> centres_;
  bool root_ = false;
  kernels::PackedDescriptors packed_;
};

/// RootSIFT in bytes: the square root of each value's share of the sum, times 512, at most 255.
std::vector<std::uint8_t> RootDescriptors(std::span<const std::uint8_t> descriptors);

}  // namespace victorious
