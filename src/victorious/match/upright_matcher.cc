#include "victorious/match/upright_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/kernels/shorten.h"

namespace victorious {
namespace {

constexpr auto kCircle_rad = static_cast<float>(2 * kPi);
constexpr std::size_t kCandidates = 4;  // by shortened descriptors

std::uint32_t Distance2(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  std::int32_t squared = 0;
  for (std::size_t i = 0; i < kDescriptorSize; ++i) squared += (a[i] - b[i]) * (a[i] - b[i]);
  return static_cast<std::uint32_t>(squared);
}

void AppendDescriptor(const FeatureView& features, std::size_t keypoint, std::vector<std::uint8_t>& rows) {
  const std::span<const std::uint8_t> row = features.Descriptor(keypoint);
  rows.insert(rows.end(), row.begin(), row.end());
}

// A keypoint of one of the templates.
struct Query {
  float orientation_rad;
  std::uint32_t model;
  std::uint32_t keypoint;
};

constexpr std::size_t kBins = 1024;  // of orientations

std::size_t BinOf(float orientation_rad) {
  const float bin = (orientation_rad / kCircle_rad + 0.5F) * static_cast<float>(kBins);
  return static_cast<std::size_t>(std::clamp(bin, 0.0F, static_cast<float>(kBins - 1)));
}

// By bins of rising orientation; in a bin in the order of the templates and their keypoints.
std::vector<Query> QueriesByOrientation(std::span<const UprightTemplate> templates) {
  std::array<std::uint32_t, kBins + 1> next{};  // of each bin: the place of its next query
  for (const UprightTemplate& one : templates) {
    for (const Keypoint& keypoint : one.features.keypoints) ++next[BinOf(keypoint.orientation_rad) + 1];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Query> queries(next.back());
  for (std::uint32_t model = 0; model < templates.size(); ++model) {
    const std::span<const Keypoint> keypoints = templates[model].features.keypoints;
    for (std::uint32_t i = 0; i < keypoints.size(); ++i) {
      queries[next[BinOf(keypoints[i].orientation_rad)]++] = {keypoints[i].orientation_rad, model, i};
    }
  }
  return queries;
}

kernels::PackedQueries PackInOrder(std::span<const UprightTemplate> templates, std::span<const Query> queries) {
  kernels::PackedQueries packed{.count = queries.size(), .row_bytes = kernels::kShortBytes, .rows = {}, .squared = {}};
  packed.rows.resize(queries.size() * kernels::kShortBytes);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const std::span<const std::int8_t> rows = templates[queries[q].model].shortened;
    std::memcpy(packed.rows.data() + q * kernels::kShortBytes, rows.data() + queries[q].keypoint * kernels::kShortBytes,
                kernels::kShortBytes);
  }
  return packed;
}

// Queries are sorted by orientation, so that their descriptors are anywhere in the templates' memory: they are fetched
// this many queries ahead.
constexpr std::size_t kFetchedAhead = 8;

void Prefetch(std::span<const std::uint8_t> descriptor) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t i = 0; i < descriptor.size(); i += kCacheLine) __builtin_prefetch(descriptor.data() + i);
}

// The absolute difference of two orientations, [0, pi].
double TurnBetween(float a, float b) {
  const double difference = std::abs(static_cast<double>(a) - b);
  return std::min(difference, 2 * kPi - difference);
}

}  // namespace

UprightMatcher::UprightMatcher(const FeatureView& scene, std::span<const float> lean_rad)
    : scene_(scene), order_(scene.size()) {
  for (std::size_t i = 0; i < scene.size(); ++i) {
    relative_rad_.push_back(static_cast<float>(WrapAngle(scene.keypoints[i].orientation_rad - lean_rad[i])));
  }
  std::iota(order_.begin(), order_.end(), 0U);
  std::ranges::stable_sort(order_, {}, [&](std::uint32_t i) { return relative_rad_[i]; });
  std::vector<std::uint8_t> rows;
  rows.reserve(scene.descriptors.size());
  for (const std::uint32_t i : order_) AppendDescriptor(scene, i, rows);
  shortened_ = kernels::Pack(kernels::Shorten(rows), kernels::kShortBytes);

  const std::size_t padded = shortened_.constant.size();
  for (std::size_t row = 0; row < 2 * padded; ++row) {
    const std::size_t i = std::min(row % padded, order_.size() - 1);
    packed_rad_.push_back(relative_rad_[order_[i]] + (row < padded ? 0.0F : kCircle_rad));
  }
  std::vector<std::uint8_t> blocks = shortened_.blocks;
  std::vector<std::int32_t> constant = shortened_.constant;
  shortened_.blocks.insert(shortened_.blocks.end(), blocks.begin(), blocks.end());
  shortened_.constant.insert(shortened_.constant.end(), constant.begin(), constant.end());
  shortened_.count = 2 * padded;  // padding inside is never nearest
}

// The blocks with all keypoints that template keypoints of orientations from first_rad to last_rad allow.
kernels::BlockRange UprightMatcher::BlocksOf(float first_rad, float last_rad, float max_turn_rad) const {
  const std::size_t blocks = shortened_.block_count() / 2;
  const float width_rad = last_rad - first_rad + 2 * max_turn_rad;
  if (width_rad >= kCircle_rad) return {0, blocks};
  float low_rad = first_rad - max_turn_rad;
  if (low_rad < -static_cast<float>(kPi)) low_rad += kCircle_rad;
  const auto begin = std::ranges::lower_bound(packed_rad_, low_rad) - packed_rad_.begin();
  const auto end = std::ranges::upper_bound(packed_rad_, low_rad + width_rad) - packed_rad_.begin();
  const std::size_t first = static_cast<std::size_t>(begin) / kernels::kBlockDescriptors;
  const std::size_t last =
      (static_cast<std::size_t>(end) + kernels::kBlockDescriptors - 1) / kernels::kBlockDescriptors;
  // More than all blocks: each keypoint of the first block would be there twice.
  return last - first > blocks ? kernels::BlockRange{0, blocks} : kernels::BlockRange{first, std::max(first, last)};
}

std::vector<std::vector<RankedMatch>> UprightMatcher::Match(std::span<const UprightTemplate> templates,
                                                            double max_turn_rad, int nearest) const {
  std::vector<std::vector<RankedMatch>> matches(templates.size());
  if (order_.empty()) return matches;
  const std::vector<Query> queries = QueriesByOrientation(templates);
  const auto turn_rad = static_cast<float>(max_turn_rad);
  std::vector<kernels::BlockRange> ranges;
  for (std::size_t q = 0; q < queries.size(); q += kernels::kRangeQueries) {
    const auto tile = std::span(queries).subspan(q, std::min(kernels::kRangeQueries, queries.size() - q));
    const auto [first, last] = std::ranges::minmax(tile, {}, &Query::orientation_rad);
    ranges.push_back(BlocksOf(first.orientation_rad, last.orientation_rad, turn_rad));
  }
  std::vector<std::uint32_t> found(queries.size() * kCandidates);
  kernels::FindShortNearest(PackInOrder(templates, queries), shortened_, kCandidates, ranges, found);

  // Per template keypoint: how many matches it has, and their scene keypoints by rank.
  struct Nearest {
    std::uint32_t count = 0;
    std::uint32_t scene_keypoint[kCandidates];
  };
  std::vector<std::vector<Nearest>> of_template(templates.size());
  for (std::size_t model = 0; model < templates.size(); ++model) {
    of_template[model].resize(templates[model].features.size());
  }
  const std::size_t padded = shortened_.constant.size() / 2;
  const std::size_t max_count = std::min(kCandidates, static_cast<std::size_t>(nearest));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Query& query = queries[q];
    if (q + kFetchedAhead < queries.size()) {
      const Query& later = queries[q + kFetchedAhead];
      Prefetch(templates[later.model].features.Descriptor(later.keypoint));
      for (const std::uint32_t candidate : std::span(found).subspan((q + kFetchedAhead) * kCandidates, kCandidates)) {
        if (candidate % padded < order_.size()) Prefetch(scene_.Descriptor(order_[candidate % padded]));
      }
    }
    std::array<std::pair<std::uint32_t, std::uint32_t>, kCandidates> near;  // distance, scene keypoint
    std::size_t count = 0;
    for (const std::uint32_t candidate : std::span(found).subspan(q * kCandidates, kCandidates)) {
      if (candidate == kernels::kNoNeighbour) break;
      const std::size_t row = candidate % padded;
      if (row >= order_.size()) continue;
      const std::uint32_t keypoint = order_[row];
      if (TurnBetween(relative_rad_[keypoint], query.orientation_rad) > max_turn_rad) continue;
      near[count++] = {
          Distance2(templates[query.model].features.Descriptor(query.keypoint), scene_.Descriptor(keypoint)), keypoint};
    }
    std::sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
    Nearest& kept = of_template[query.model][query.keypoint];
    kept.count = static_cast<std::uint32_t>(std::min(count, max_count));
    for (std::size_t rank = 0; rank < kept.count; ++rank) kept.scene_keypoint[rank] = near[rank].second;
  }
  for (std::size_t model = 0; model < templates.size(); ++model) {
    matches[model].reserve(of_template[model].size() * max_count);
    for (std::uint32_t i = 0; i < of_template[model].size(); ++i) {
      const Nearest& kept = of_template[model][i];
      for (std::uint32_t rank = 0; rank < kept.count; ++rank) {
        matches[model].push_back({kept.scene_keypoint[rank], i, rank + 1});
      }
    }
  }
  return matches;
}

}  // namespace victorious
