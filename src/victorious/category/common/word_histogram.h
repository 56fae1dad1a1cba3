// Histogram of an image's visual words, as a sparse vector.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "victorious/category/common/quantised_image.h"

namespace victorious {

/// A sparse vector: (index, value) pairs by increasing index.
using SparseVector = std::vector<std::pair<std::uint32_t, float>>;

/// Dot product.
double Dot(const SparseVector& a, const SparseVector& b);

/// Histogram of words: the soft-assignment weights summed over the keypoints.
/// @param words  size of the vocabulary
SparseVector CountWords(const QuantisedImage& image, std::size_t words);

}  // namespace victorious
