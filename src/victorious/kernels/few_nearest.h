// Shared by the vector implementations of FindNearestFew: one query's few nearest so far.
#pragma once

#include <cstddef>
#include <cstdint>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

/// Larger than any |b|^2 - 256 sum(b) - 2 q.b of real descriptors (below 2^25), and far from overflow: that of padding.
inline constexpr std::int32_t kNeverLeast = 1 << 29;

/// Partial distances, which lack |q|^2, in ascending order; kNeverLeast where nothing was found yet. Descriptors come
/// in the order of their indices, so that of equal distances the lower index stays first.
class FewNearest {
 public:
  explicit FewNearest(std::size_t few) : few_(few) {
    for (std::int32_t& distance : distance_) distance = kNeverLeast;
  }

  /// What a descriptor must be nearer than to get in.
  [[nodiscard]] std::int32_t Worst() const { return distance_[few_ - 1]; }

  void Insert(std::int32_t distance, std::uint32_t index) {
    if (distance >= Worst()) return;
    std::size_t place = few_ - 1;
    for (; place > 0 && distance < distance_[place - 1]; --place) {
      distance_[place] = distance_[place - 1];
      index_[place] = index_[place - 1];
    }
    distance_[place] = distance;
    index_[place] = index;
  }

  void Write(std::int32_t query_squared, Neighbour* out) const {
    for (std::size_t i = 0; i < few_; ++i) {
      out[i] = {};
      if (distance_[i] < kNeverLeast) out[i] = {index_[i], static_cast<std::uint32_t>(distance_[i] + query_squared)};
    }
  }

 private:
  std::size_t few_;
  std::int32_t distance_[kMostNeighbours];
  std::uint32_t index_[kMostNeighbours] = {};
};

}  // namespace victorious::kernels
