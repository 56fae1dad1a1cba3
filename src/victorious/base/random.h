// A seeded random number generator. The same seed gives the same numbers on every machine and compiler (unlike the
// distributions of the standard library).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "victorious/base/check.h"

namespace victorious {

/// SplitMix64 (Steele, Lea, Flood 2014): 64 bits of state, passes BigCrush, a few cycles per number.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, bound), with a bias below 2^-32 (Lemire's multiplication). bound >= 1.
  std::uint32_t Below(std::uint32_t bound) {
    VICTORIOUS_CHECK(bound > 0);
    return static_cast<std::uint32_t>(((Next() >> 32) * bound) >> 32);
  }

  /// Uniform in [0, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }

  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// Standard normal, by Box and Muller.
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  std::uint64_t state_;
};

/// Returns the seed of stream number `stream` (below 2^32) of `seed`. Streams, and the same streams of other seeds, are
/// statistically independent: one stream for each purpose, square or frame.
[[nodiscard]] inline std::uint64_t MixSeed(std::uint64_t seed, std::uint64_t stream) {
  return Random(seed ^ (stream << 32)).Next();
}

}  // namespace victorious
