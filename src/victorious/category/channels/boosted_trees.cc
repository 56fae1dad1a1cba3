#include "victorious/category/channels/boosted_trees.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/random.h"
#include "victorious/kernels/window_trees.h"

namespace victorious {
namespace {

constexpr int kBins = 64;
constexpr int kBinShift = 2;  // of bytes

struct Derivatives {
  float gradient = 0;
  float curvature = 0;

  Derivatives& operator+=(const Derivatives& other) {
    gradient += other.gradient;
    curvature += other.curvature;
    return *this;
  }
};

struct FeatureSplit {
  double gain = -1;
  std::uint16_t feature = 0;
  std::uint8_t threshold = 0;
};

class TreeTrainer {
 public:
  TreeTrainer(const BoostExamples& examples, const BoostOptions& options, std::uint64_t seed)
      : options_(options),
        random_(seed),
        features_(examples.features),
        positives_(examples.positives.size()),
        count_(positives_ + examples.negatives.size()),
        bytes_(features_ * count_),
        scores_(count_),
        derivatives_(count_),
        node_(count_) {
    // Feature by feature, in blocks of examples that the cache holds.
    constexpr std::size_t kBlock = 64;
    for (std::size_t first = 0; first < count_; first += kBlock) {
      for (std::size_t f = 0; f < features_; ++f) {
        for (std::size_t i = first; i < std::min(count_, first + kBlock); ++i) {
          bytes_[f * count_ + i] = i < positives_ ? examples.positives[i][f] : examples.negatives[i - positives_][f];
        }
      }
    }
    positive_weight_ = static_cast<double>(count_) / (2.0 * static_cast<double>(positives_));
    negative_weight_ = static_cast<double>(count_) / (2.0 * static_cast<double>(count_ - positives_));
  }

  BoostedTrees Train() {
    BoostedTrees model;
    std::vector<std::vector<int>> partial;  // of the positives, by stage
    for (int t = 0; t < options_.trees; ++t) {
      UpdateDerivatives();
      model.trees.push_back(TrainTree());
      const bool ends_stage = model.trees.size() % kernels::kTreesPerStage == 0 || t + 1 == options_.trees;
      if (ends_stage) partial.emplace_back(scores_.begin(), scores_.begin() + static_cast<std::ptrdiff_t>(positives_));
    }
    model.floors = FloorsOf(partial);
    return model;
  }

 private:
  void UpdateDerivatives() {
    for (std::size_t i = 0; i < count_; ++i) {
      const double p = 1 / (1 + std::exp(-scores_[i] / kLeafScale));
      const double weight = i < positives_ ? positive_weight_ : negative_weight_;
      derivatives_[i] = {.gradient = static_cast<float>(weight * ((i < positives_ ? 1.0 : 0.0) - p)),
                         .curvature = static_cast<float>(weight * p * (1 - p))};
    }
    std::ranges::fill(node_, std::uint8_t{0});
  }

  // The best split of each of the nodes.
  std::vector<FeatureSplit> BestSplits(std::span<const std::uint16_t> tried, std::size_t nodes) const {
    std::vector<std::vector<FeatureSplit>> of_feature(tried.size());
    oneapi::tbb::parallel_for(std::size_t{0}, tried.size(), [&](std::size_t k) {
      std::array<Derivatives, 2 * kBins> bins{};
      const std::uint8_t* const bytes = bytes_.data() + tried[k] * count_;
      for (std::size_t i = 0; i < count_; ++i) bins[node_[i] * kBins + (bytes[i] >> kBinShift)] += derivatives_[i];
      for (std::size_t n = 0; n < nodes; ++n) of_feature[k].push_back(BestSplit(bins.data() + n * kBins, tried[k]));
    });
    std::vector<FeatureSplit> best(nodes);
    for (const std::vector<FeatureSplit>& splits : of_feature) {
      for (std::size_t n = 0; n < nodes; ++n) {
        if (splits[n].gain > best[n].gain) best[n] = splits[n];
      }
    }
    return best;
  }

  FeatureSplit BestSplit(const Derivatives* bins, std::uint16_t feature) const {
    Derivatives all;
    for (int b = 0; b < kBins; ++b) all += bins[b];
    FeatureSplit best;
    Derivatives below;
    for (int b = 0; b + 1 < kBins; ++b) {
      below += bins[b];
      const Derivatives above{all.gradient - below.gradient, all.curvature - below.curvature};
      const double gain = GainOf(below) + GainOf(above);
      if (gain > best.gain) best = {gain, feature, static_cast<std::uint8_t>((b + 1) << kBinShift)};
    }
    return best;
  }

  [[nodiscard]] double GainOf(const Derivatives& sum) const {
    return static_cast<double>(sum.gradient) * sum.gradient / (sum.curvature + options_.damping);
  }

  // Sends the examples to the nodes below.
  void Divide(std::span<const FeatureSplit> splits) {
    for (std::size_t i = 0; i < count_; ++i) {
      const FeatureSplit& split = splits[node_[i]];
      const bool is_below = bytes_[split.feature * count_ + i] < split.threshold;
      node_[i] = static_cast<std::uint8_t>(2 * node_[i] + (is_below ? 0 : 1));
    }
  }

  FeatureTree TrainTree() {
    std::vector<std::uint16_t> tried(std::min(features_, static_cast<std::size_t>(options_.features)));
    for (std::uint16_t& f : tried) {
      f = static_cast<std::uint16_t>(random_.Below(static_cast<std::uint32_t>(features_)));
    }
    const std::vector<FeatureSplit> root = BestSplits(tried, 1);
    Divide(root);
    const std::vector<FeatureSplit> below = BestSplits(tried, 2);
    Divide(below);
    FeatureTree tree{.feature = {root[0].feature, below[0].feature, below[1].feature},
                     .threshold = {root[0].threshold, below[0].threshold, below[1].threshold}};
    std::array<std::array<double, 2>, 4> sums{};
    for (std::size_t i = 0; i < count_; ++i) {
      sums[node_[i]][0] += derivatives_[i].gradient;
      sums[node_[i]][1] += derivatives_[i].curvature;
    }
    for (std::size_t n = 0; n < sums.size(); ++n) {
      const double step = options_.rate * kLeafScale * sums[n][0] / (sums[n][1] + options_.damping);
      constexpr double kMost = std::numeric_limits<std::int8_t>::max();
      tree.leaf[n] = static_cast<std::int8_t>(std::lround(std::clamp(step, -kMost, kMost)));
    }
    for (std::size_t i = 0; i < count_; ++i) scores_[i] += tree.leaf[node_[i]];
    return tree;
  }

  std::vector<std::int16_t> FloorsOf(const std::vector<std::vector<int>>& partial) const {
    std::vector<int> last(partial.back());
    const auto lost = static_cast<std::size_t>(options_.lost * static_cast<double>(positives_));
    std::ranges::nth_element(last, last.begin() + static_cast<std::ptrdiff_t>(lost));
    const int kept = last[lost];
    std::vector<std::int16_t> floors;
    for (const std::vector<int>& sums : partial) {
      int floor = std::numeric_limits<std::int16_t>::max();
      for (std::size_t i = 0; i < positives_; ++i) {
        if (partial.back()[i] >= kept) floor = std::min(floor, sums[i]);
      }
      floor -= static_cast<int>(options_.slack * kLeafScale);
      floors.push_back(static_cast<std::int16_t>(std::max(floor, -std::numeric_limits<std::int16_t>::max())));
    }
    return floors;
  }

  BoostOptions options_;
  Random random_;
  std::size_t features_;
  std::size_t positives_;
  std::size_t count_;
  double positive_weight_ = 1;
  double negative_weight_ = 1;
  std::vector<std::uint8_t> bytes_;
  std::vector<int> scores_;
  std::vector<Derivatives> derivatives_;
  std::vector<std::uint8_t> node_;
};

}  // namespace

BoostedTrees TrainTrees(const BoostExamples& examples, const BoostOptions& options, std::uint64_t seed) {
  if (examples.positives.empty() || examples.negatives.empty() || examples.features == 0) return {};
  return TreeTrainer(examples, options, seed).Train();
}

int ScoreExample(const BoostedTrees& trees, std::span<const std::uint8_t> features) {
  int sum = 0;
  for (const FeatureTree& tree : trees.trees) {
    const std::size_t side = features[tree.feature[0]] < tree.threshold[0] ? 0 : 1;
    sum += tree.leaf[2 * side + (features[tree.feature[1 + side]] < tree.threshold[1 + side] ? 0 : 1)];
  }
  return sum;
}

}  // namespace victorious
