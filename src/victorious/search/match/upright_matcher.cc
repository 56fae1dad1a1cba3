#include "victorious/search/match/upright_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "victorious/geometry/angles.h"
#include "victorious/kernels/descriptor_distance.h"
#include "victorious/kernels/shorten.h"

namespace victorious {
namespace {

constexpr auto kCircle_rad = static_cast<float>(2 * kPi);
constexpr std::size_t kCandidates = 4;  // by shortened descriptors
// A cell's list: this part of the scene's keypoints, but at least so many.
constexpr std::size_t kListedFraction = 4;
constexpr std::size_t kMinListed = 512;
// Of whole descriptors, whose norm is 512: an angle of 42 degrees. Beyond it lie three in ten nearest
// neighbours, and less than 2 % of the inliers of significant proposals (docs/adr/0018).
constexpr std::uint32_t kMaxDistance2 = 136'000;

std::size_t BinOf(float orientation_rad, std::size_t bins) {
  const float bin = (orientation_rad / kCircle_rad + 0.5F) * static_cast<float>(bins);
  return static_cast<std::size_t>(std::clamp(bin, 0.0F, static_cast<float>(bins - 1)));
}

// A keypoint of one of the templates.
struct Query {
  std::uint32_t model;
  std::uint32_t keypoint;
};

// The keypoints of all templates by cell: those of cell c from first[c] to first[c + 1]; in a cell in the order of the
// templates and their keypoints.
struct QueriesByCell {
  std::array<std::uint32_t, kDescriptorCells + 1> first{};
  std::vector<Query> queries;
};

QueriesByCell SortByCell(std::span<const UprightTemplate> templates) {
  QueriesByCell sorted;
  for (const UprightTemplate& one : templates) {
    for (const std::uint16_t cell : one.shortened->cells) ++sorted.first[cell + 1U];
  }
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  sorted.queries.resize(sorted.first.back());
  std::array<std::uint32_t, kDescriptorCells + 1> next = sorted.first;
  for (std::uint32_t model = 0; model < templates.size(); ++model) {
    const std::span<const std::uint16_t> cells = templates[model].shortened->cells;
    for (std::uint32_t i = 0; i < cells.size(); ++i) sorted.queries[next[cells[i]]++] = {model, i};
  }
  return sorted;
}

// The greatest half distance to keep so that at least `count` of all are kept, but for rounding to bins, and at most
// kMaxShortSet, but for equal distances.
std::int32_t ChooseMaxDistance(std::span<const std::int32_t> half_distances, std::size_t count) {
  constexpr std::int32_t kBin = 256;
  const auto [nearest, farthest] = std::ranges::minmax(half_distances);
  const auto bin_of = [nearest = nearest](std::int32_t distance) {
    return static_cast<std::size_t>((distance - nearest) / kBin);
  };
  std::vector<std::uint32_t> bins(bin_of(farthest) + 1);
  for (const std::int32_t distance : half_distances) ++bins[bin_of(distance)];
  std::size_t before = 0;  // those in the bins before this one
  std::size_t bin = 0;
  const std::size_t wanted = std::min(count, kernels::kMaxShortSet);
  while (bin + 1 < bins.size() && before + bins[bin] < wanted) before += bins[bin++];
  if (before + bins[bin] <= kernels::kMaxShortSet) return nearest - 1 + kBin * static_cast<std::int32_t>(bin + 1);
  std::vector<std::int32_t> in_bin;
  in_bin.reserve(bins[bin]);
  for (const std::int32_t distance : half_distances) {
    if (bin_of(distance) == bin) in_bin.push_back(distance);
  }
  const auto last = in_bin.begin() + static_cast<std::ptrdiff_t>(kernels::kMaxShortSet - before) - 1;
  std::ranges::nth_element(in_bin, last);
  return *last;
}

// Queries are sorted by cell, so that their descriptors are anywhere in the templates' memory: they are fetched
// this many queries ahead.
constexpr std::size_t kFetchedAhead = 8;

void Prefetch(std::span<const std::uint8_t> descriptor) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t i = 0; i < descriptor.size(); i += kCacheLine) __builtin_prefetch(descriptor.data() + i);
}

}  // namespace

UprightMatcher::UprightMatcher(const FeatureView& scene, std::span<const float> lean_rad)
    : scene_(scene), order_(scene.size()), lists_(std::make_unique<Lists>()) {
  for (std::size_t i = 0; i < scene.size(); ++i) {
    relative_rad_.push_back(static_cast<float>(WrapAngle(scene.keypoints[i].orientation_rad - lean_rad[i])));
  }
  std::iota(order_.begin(), order_.end(), 0U);
  std::ranges::stable_sort(order_, {}, [&](std::uint32_t i) { return relative_rad_[i]; });
  const std::vector<std::uint8_t> rows = kernels::Shorten(scene.descriptors);
  std::vector<std::uint8_t> sorted;
  sorted.reserve(rows.size());
  bins_.reserve(order_.size());
  for (const std::uint32_t i : order_) {
    const auto row = std::span(rows).subspan(i * kernels::kShortBytes, kernels::kShortBytes);
    sorted.insert(sorted.end(), row.begin(), row.end());
    bins_.push_back(static_cast<std::uint8_t>(BinOf(relative_rad_[i], kOrientationBins)));
  }
  packed_ = kernels::PackShort(sorted);
}

const UprightMatcher::CellList& UprightMatcher::ListOf(std::size_t cell) const {
  std::call_once(lists_->once[cell], [&] { lists_->lists[cell] = MakeList(cell); });
  return lists_->lists[cell];
}

UprightMatcher::CellList UprightMatcher::MakeList(std::size_t cell) const {
  std::vector<std::int32_t> half_distances(packed_.half_constant.size());
  kernels::ComputeHalfDistances(CellCentre(cell), packed_, half_distances);
  half_distances.resize(packed_.count);
  const std::size_t wanted = std::max(kMinListed, packed_.count / kListedFraction);
  const std::int32_t max_distance = ChooseMaxDistance(half_distances, wanted);
  std::vector<std::uint32_t> near(order_.size());  // places in order_
  std::size_t count = 0;
  for (std::uint32_t k = 0; k < order_.size(); ++k) {  // no branches: a quarter of them is near, in no pattern
    near[count] = k;
    count += static_cast<std::size_t>(half_distances[k] <= max_distance);
  }
  near.resize(std::min(count, kernels::kMaxShortSet));
  CellList list;
  list.first.fill(0);
  list.keypoints.reserve(near.size());
  for (const std::uint32_t k : near) {
    list.keypoints.push_back(order_[k]);
    ++list.first[bins_[k] + 1U];
  }
  std::partial_sum(list.first.begin(), list.first.end(), list.first.begin());
  list.descriptors = kernels::SelectShort(packed_, near);
  return list;
}

// The blocks with all keypoints that a template keypoint of this orientation allows.
kernels::QueryBlocks UprightMatcher::BlocksOf(const CellList& list, float orientation_rad, float max_turn_rad) {
  const std::size_t blocks = list.descriptors.block_count();
  if (2 * max_turn_rad >= kCircle_rad) return {{0, blocks}, {}};
  // The blocks of the keypoints in the bins of the orientations from low_rad to high_rad.
  const auto range = [&](float low_rad, float high_rad) -> kernels::BlockRange {
    const std::size_t begin = list.first[BinOf(low_rad, kOrientationBins)];
    const std::size_t end = list.first[BinOf(high_rad, kOrientationBins) + 1];
    return {begin / kernels::kBlockDescriptors, (end + kernels::kBlockDescriptors - 1) / kernels::kBlockDescriptors};
  };
  const float low_rad = orientation_rad - max_turn_rad;
  const float high_rad = orientation_rad + max_turn_rad;
  constexpr auto kHalfCircle_rad = static_cast<float>(kPi);
  kernels::QueryBlocks found{range(low_rad, high_rad), {}};
  if (low_rad < -kHalfCircle_rad) {
    found = {range(-kHalfCircle_rad, high_rad), range(low_rad + kCircle_rad, kHalfCircle_rad)};
  } else if (high_rad > kHalfCircle_rad) {
    found = {range(-kHalfCircle_rad, high_rad - kCircle_rad), range(low_rad, kHalfCircle_rad)};
  }
  const bool overlap = found.high.first < found.high.last && found.high.first < found.low.last;
  return overlap ? kernels::QueryBlocks{{0, blocks}, {}} : found;
}

std::vector<std::vector<RankedMatch>> UprightMatcher::Match(std::span<const UprightTemplate> templates,
                                                            double max_turn_rad, int nearest) const {
  std::vector<std::vector<RankedMatch>> matches(templates.size());
  if (order_.empty()) return matches;
  const QueriesByCell sorted = SortByCell(templates);
  const std::vector<Query>& queries = sorted.queries;
  const auto turn_rad = static_cast<float>(max_turn_rad);
  std::vector<std::uint32_t> found(queries.size() * kCandidates);  // indices into scene_
  std::vector<const std::int8_t*> rows;
  std::vector<kernels::QueryBlocks> blocks;
  for (std::size_t cell = 0; cell < kDescriptorCells; ++cell) {
    const std::size_t first = sorted.first[cell];
    const std::size_t count = sorted.first[cell + 1] - first;
    if (count == 0) continue;
    const CellList& list = ListOf(cell);
    rows.clear();
    blocks.clear();
    for (const Query& query : std::span(queries).subspan(first, count)) {
      const UprightTemplate& one = templates[query.model];
      rows.push_back(one.shortened->rows.data() + query.keypoint * kernels::kShortBytes);
      blocks.push_back(BlocksOf(list, one.features.keypoints[query.keypoint].orientation_rad, turn_rad));
    }
    const std::span<std::uint32_t> of_cell = std::span(found).subspan(first * kCandidates, count * kCandidates);
    kernels::FindShortNearest(rows, list.descriptors, kCandidates, blocks, of_cell);
    for (std::uint32_t& one : of_cell) {
      if (one != kernels::kNoNeighbour) one = list.keypoints[one];
    }
  }

  // Per template keypoint: how many matches it has, and their scene keypoints by rank.
  struct Nearest {
    std::uint32_t count = 0;
    std::uint32_t scene_keypoint[kCandidates];
  };
  std::vector<std::vector<Nearest>> of_template(templates.size());
  for (std::size_t model = 0; model < templates.size(); ++model) {
    of_template[model].resize(templates[model].features.size());
  }
  const std::size_t max_count = std::min(kCandidates, static_cast<std::size_t>(nearest));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Query& query = queries[q];
    if (q + kFetchedAhead < queries.size()) {
      const Query& later = queries[q + kFetchedAhead];
      Prefetch(templates[later.model].features.Descriptor(later.keypoint));
      for (const std::uint32_t candidate : std::span(found).subspan((q + kFetchedAhead) * kCandidates, kCandidates)) {
        if (candidate != kernels::kNoNeighbour) Prefetch(scene_.Descriptor(candidate));
      }
    }
    const FeatureView& features = templates[query.model].features;
    const float orientation_rad = features.keypoints[query.keypoint].orientation_rad;
    std::array<std::uint32_t, kCandidates> allowed;  // scene keypoints
    std::array<const std::uint8_t*, kCandidates> descriptors;
    std::size_t allowed_count = 0;
    for (const std::uint32_t keypoint : std::span(found).subspan(q * kCandidates, kCandidates)) {
      if (keypoint == kernels::kNoNeighbour) break;
      if (AngleBetween(relative_rad_[keypoint], orientation_rad) > max_turn_rad) continue;
      descriptors[allowed_count] = scene_.Descriptor(keypoint).data();
      allowed[allowed_count++] = keypoint;
    }
    std::array<std::uint32_t, kCandidates> distances2;
    kernels::ComputeDescriptorDistances(features.Descriptor(query.keypoint).data(),
                                        std::span(descriptors).first(allowed_count), distances2);
    std::array<std::pair<std::uint32_t, std::uint32_t>, kCandidates> near;  // squared distance, scene keypoint
    std::size_t count = 0;
    for (std::size_t i = 0; i < allowed_count; ++i) {
      if (distances2[i] <= kMaxDistance2) near[count++] = {distances2[i], allowed[i]};
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
