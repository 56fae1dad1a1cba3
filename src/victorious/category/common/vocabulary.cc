#include "victorious/category/common/vocabulary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "victorious/base/check.h"
#include "victorious/base/random.h"
#include "victorious/category/common/sampling.h"

namespace victorious {
namespace {

using kernels::Neighbour;

std::span<const std::uint8_t> RowOf(std::span<const std::uint8_t> rows, std::size_t i) {
  return rows.subspan(i * kDescriptorSize, kDescriptorSize);
}

// Nearest words of each row, in parallel over blocks. Each result depends only on its query, not on the blocks.
std::vector<Neighbour> Nearest(std::span<const std::uint8_t> rows, const kernels::PackedDescriptors& set,
                               std::size_t k) {
  constexpr std::size_t kBlock = 1024;
  const std::size_t count = rows.size() / kDescriptorSize;
  std::vector<Neighbour> out(count * k);
  const std::size_t blocks = (count + kBlock - 1) / kBlock;
  oneapi::tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t first = block * kBlock;
    const std::size_t size = std::min(kBlock, count - first);
    const auto queries = kernels::PackQueries(rows.subspan(first * kDescriptorSize, size * kDescriptorSize));
    kernels::FindNearestK(queries, set, k, std::span(out).subspan(first * k, size * k));
  });
  return out;
}

// Samples at most `max_count` rows, in random order.
std::vector<std::uint8_t> SampleRows(std::span<const std::uint8_t> rows, std::size_t max_count, Random& random) {
  std::vector<std::uint8_t> drawn;
  for (const std::uint32_t i : SampleIndices(rows.size() / kDescriptorSize, max_count, random)) {
    const auto row = RowOf(rows, i);
    drawn.insert(drawn.end(), row.begin(), row.end());
  }
  return drawn;
}

// The means of the samples assigned to each centre. An empty cluster is re-initialised with the sample farthest
// from its centre, each empty cluster with a different sample.
std::vector<std::uint8_t> UpdateCentres(std::span<const std::uint8_t> samples, std::span<const Neighbour> nearest,
                                        std::size_t words) {
  std::vector<std::uint32_t> sums(words * kDescriptorSize);
  std::vector<std::uint32_t> counts(words);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    ++counts[nearest[i].index];
    std::uint32_t* sum = &sums[nearest[i].index * kDescriptorSize];
    const auto row = RowOf(samples, i);
    for (std::size_t k = 0; k < kDescriptorSize; ++k) sum[k] += row[k];
  }
  std::vector<std::uint32_t> farthest(nearest.size());
  std::iota(farthest.begin(), farthest.end(), 0U);
  const auto empty = static_cast<std::size_t>(std::ranges::count(counts, 0U));
  const auto farthest_end = farthest.begin() + static_cast<std::ptrdiff_t>(std::min(empty, farthest.size()));
  std::partial_sort(farthest.begin(), farthest_end, farthest.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(nearest[b].distance2, a) < std::pair(nearest[a].distance2, b);
  });
  auto next_farthest = farthest.begin();
  std::vector<std::uint8_t> means(words * kDescriptorSize);
  for (std::size_t word = 0; word < words; ++word) {
    std::uint8_t* mean = &means[word * kDescriptorSize];
    if (counts[word] == 0) {
      std::ranges::copy(RowOf(samples, *next_farthest++), mean);
      continue;
    }
    for (std::size_t k = 0; k < kDescriptorSize; ++k)
      mean[k] = static_cast<std::uint8_t>((sums[word * kDescriptorSize + k] + counts[word] / 2) / counts[word]);
  }
  return means;
}

}  // namespace

void VocabularyOptions::ListFields(FieldList& fields) {
  fields.Add("words", words, {.min = 2, .max = 65536, .reason = "size of the vocabulary (thesis: 3000)"});
  fields.Add("root", root,
             {.reason = "compare the square roots of descriptors (RootSIFT), which limits the influence of single "
                        "strong gradients; thesis: false"});
  fields.Add("iterations", iterations, {.min = 1, .max = 1000, .reason = "iterations of k-means"});
}

Vocabulary::Vocabulary(std::vector<std::uint8_t> centres, bool root)
    : centres_(std::move(centres)), root_(root), packed_(kernels::Pack(centres_)) {}

Vocabulary Vocabulary::Learn(std::span<const std::uint8_t> descriptors, const VocabularyOptions& options,
                             std::uint64_t seed) {
  VICTORIOUS_CHECK(descriptors.size() >= kDescriptorSize && descriptors.size() % kDescriptorSize == 0);
  Random random(seed);
  std::vector<std::uint8_t> samples = SampleRows(descriptors, static_cast<std::size_t>(options.samples), random);
  if (options.root) samples = RootDescriptors(samples);
  // The samples are in random order, so the first ones are a random initialisation.
  const std::size_t words = std::min(static_cast<std::size_t>(options.words), samples.size() / kDescriptorSize);
  std::vector<std::uint8_t> centres(samples.begin(),
                                    samples.begin() + static_cast<std::ptrdiff_t>(words * kDescriptorSize));
  for (int i = 0; i < options.iterations; ++i) {
    std::vector<std::uint8_t> means = UpdateCentres(samples, Nearest(samples, kernels::Pack(centres), 1), words);
    const bool converged = means == centres;
    centres = std::move(means);
    if (converged) break;
  }
  return {std::move(centres), options.root};
}

Vocabulary Vocabulary::Learn(std::span<const FeatureSet* const> sets, const VocabularyOptions& options,
                             std::uint64_t seed) {
  std::vector<std::uint8_t> descriptors;
  for (const FeatureSet* set : sets)
    descriptors.insert(descriptors.end(), set->descriptors.begin(), set->descriptors.end());
  return Learn(descriptors, options, seed);
}

std::vector<Neighbour> Vocabulary::NearestWords(std::span<const std::uint8_t> descriptors, std::size_t k) const {
  if (!root_) return Nearest(descriptors, packed_, k);
  return Nearest(RootDescriptors(descriptors), packed_, k);
}

std::vector<std::uint8_t> RootDescriptors(std::span<const std::uint8_t> descriptors) {
  constexpr double kUnit = 512;
  std::vector<std::uint8_t> roots(descriptors.size());
  std::array<double, 256> root_of_value;
  for (std::size_t value = 0; value < root_of_value.size(); ++value)
    root_of_value[value] = std::sqrt(static_cast<double>(value));
  for (std::size_t first = 0; first < descriptors.size(); first += kDescriptorSize) {
    const auto row = descriptors.subspan(first, kDescriptorSize);
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    const double factor = sum > 0 ? kUnit / std::sqrt(sum) : 0.0;
    for (std::size_t k = 0; k < kDescriptorSize; ++k)
      roots[first + k] = static_cast<std::uint8_t>(std::min(255.0, root_of_value[row[k]] * factor + 0.5));
  }
  return roots;
}

}  // namespace victorious
