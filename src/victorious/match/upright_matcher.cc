#include "victorious/match/upright_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
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

std::vector<Query> SortedQueries(std::span<const FeatureView> templates) {
  std::vector<Query> queries;
  for (std::size_t model = 0; model < templates.size(); ++model) {
    for (std::size_t i = 0; i < templates[model].size(); ++i) {
      queries.push_back({templates[model].keypoints[i].orientation_rad, static_cast<std::uint32_t>(model),
                         static_cast<std::uint32_t>(i)});
    }
  }
  std::ranges::stable_sort(queries, {}, &Query::orientation_rad);
  return queries;
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

std::vector<std::vector<RankedMatch>> UprightMatcher::Match(std::span<const FeatureView> templates, double max_turn_rad,
                                                            int nearest) const {
  std::vector<std::vector<RankedMatch>> matches(templates.size());
  if (order_.empty()) return matches;
  const std::vector<Query> queries = SortedQueries(templates);
  std::vector<std::uint8_t> rows;
  rows.reserve(queries.size() * kDescriptorSize);
  for (const Query& query : queries) AppendDescriptor(templates[query.model], query.keypoint, rows);
  const auto turn_rad = static_cast<float>(max_turn_rad);
  std::vector<kernels::BlockRange> ranges;
  for (std::size_t q = 0; q < queries.size(); q += kernels::kRangeQueries) {
    const std::size_t last = std::min(q + kernels::kRangeQueries, queries.size()) - 1;
    ranges.push_back(BlocksOf(queries[q].orientation_rad, queries[last].orientation_rad, turn_rad));
  }
  std::vector<kernels::Neighbour> found(queries.size() * kCandidates);
  kernels::FindNearestKInRanges(kernels::PackQueries(kernels::Shorten(rows), kernels::kShortBytes), shortened_,
                                kCandidates, ranges, found);

  const std::size_t padded = shortened_.constant.size() / 2;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> near;  // distance, scene keypoint
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Query& query = queries[q];
    near.clear();
    for (const kernels::Neighbour& candidate : std::span(found).subspan(q * kCandidates, kCandidates)) {
      const std::size_t row = candidate.index % padded;
      if (candidate.distance2 == kernels::kNoDistance || row >= order_.size()) continue;
      const std::uint32_t keypoint = order_[row];
      if (std::abs(WrapAngle(relative_rad_[keypoint] - query.orientation_rad)) > max_turn_rad) continue;
      near.emplace_back(Distance2(templates[query.model].Descriptor(query.keypoint), scene_.Descriptor(keypoint)),
                        keypoint);
    }
    std::ranges::sort(near);
    const std::size_t count = std::min(near.size(), static_cast<std::size_t>(nearest));
    for (std::size_t rank = 0; rank < count; ++rank) {
      matches[query.model].push_back({near[rank].second, query.keypoint, static_cast<std::uint32_t>(rank + 1)});
    }
  }
  for (std::vector<RankedMatch>& of_template : matches) {
    std::ranges::stable_sort(of_template, {}, &RankedMatch::template_keypoint);
  }
  return matches;
}

}  // namespace victorious
