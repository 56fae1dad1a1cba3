// Shared by the vector implementations of FindNearestK: the running k nearest descriptors of one query.
#pragma once

#include <cstddef>
#include <cstdint>

#include "victorious/kernels/nearest.h"

namespace victorious::kernels {

/// The constant of padding descriptors: larger than |b|^2 - 256 sum(b) - 2 q.b of any real descriptor (below 2^25), and
/// far from overflow.
inline constexpr std::int32_t kPaddingDistance = 1 << 29;

/// Partial distances (without |q|^2) in ascending order; kPaddingDistance in empty slots. Descriptors must be inserted
/// in the order of their indices, so that the lower index stays first among equal distances.
class KNearest {
 public:
  explicit KNearest(std::size_t k) : k_(k) {
    for (std::int32_t& distance : distance_) distance = kPaddingDistance;
  }

  /// The k-th smallest partial distance so far: a descriptor must be nearer to be inserted.
  [[nodiscard]] std::int32_t Worst() const { return distance_[k_ - 1]; }

  void Insert(std::int32_t distance, std::uint32_t index) {
    if (distance >= Worst()) return;
    std::size_t slot = k_ - 1;
    for (; slot > 0 && distance < distance_[slot - 1]; --slot) {
      distance_[slot] = distance_[slot - 1];
      index_[slot] = index_[slot - 1];
    }
    distance_[slot] = distance;
    index_[slot] = index;
  }

  void Write(std::int32_t query_squared, Neighbour* out) const {
    for (std::size_t i = 0; i < k_; ++i) {
      out[i] = {};
      if (distance_[i] < kPaddingDistance)
        out[i] = {index_[i], static_cast<std::uint32_t>(distance_[i] + query_squared)};
    }
  }

 private:
  std::size_t k_;
  std::int32_t distance_[kMaxNeighbours];
  std::uint32_t index_[kMaxNeighbours] = {};
};

}  // namespace victorious::kernels
