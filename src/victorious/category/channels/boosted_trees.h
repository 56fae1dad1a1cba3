// Training of boosted trees of two levels on bytes, for kernels/window_trees.h.
// Method: Newton steps on the logistic loss (J. Friedman, T. Hastie, R. Tibshirani, "Additive logistic regression",
// 2000), trees by histograms over a random part of the features; leaves are rounded to bytes of 1 / kLeafScale before
// the next tree is trained, so that the detector's sums are the trained ones. The floors of the cascade are those of
// the positive examples (P. Dollár et al., 2014).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace victorious {

inline constexpr double kLeafScale = 64;  ///< a score of one unit of log odds

struct FeatureTree {
  std::array<std::uint16_t, 3> feature{};
  std::array<std::uint8_t, 3> threshold{};
  std::array<std::int8_t, 4> leaf{};

  bool operator==(const FeatureTree&) const = default;
};

struct BoostedTrees {
  std::vector<FeatureTree> trees;
  std::vector<std::int16_t> floors;  ///< one a stage (kernels::kTreesPerStage)

  bool operator==(const BoostedTrees&) const = default;
};

struct BoostOptions {
  int trees = 256;
  int features = 192;  ///< tried a tree
  double rate = 0.2;   ///< of a Newton step
  double damping = 4;  ///< added to a leaf's second derivative, in mean examples
  double lost = 0;     ///< positives that the cascade may reject
  double slack = 1.0;  ///< log odds below the lowest of the others
};

/// Examples of a class and of all others, as rows of bytes.
struct BoostExamples {
  std::size_t features = 0;
  std::vector<std::vector<std::uint8_t>> positives;
  std::vector<std::vector<std::uint8_t>> negatives;
};

/// Deterministic for a seed. Without examples of both classes: no trees.
[[nodiscard]] BoostedTrees TrainTrees(const BoostExamples& examples, const BoostOptions& options, std::uint64_t seed);

/// The score of an example, without the cascade.
[[nodiscard]] int ScoreExample(const BoostedTrees& trees, std::span<const std::uint8_t> features);

}  // namespace victorious
