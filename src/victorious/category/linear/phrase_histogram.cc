#include "victorious/category/linear/phrase_histogram.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Scale level of a keypoint: levels differ by a factor of 1.5, as the scales of DenseFeatures.
int SizeLevel(const Keypoint& keypoint) {
  constexpr double kLevelsPerNat = 2.466;  // 1 / ln 1.5
  return static_cast<int>(std::lround(std::log(keypoint.scale_px) * kLevelsPerNat));
}

constexpr float kCellsPerScale = 3;  // width of a descriptor's cell, in sigma

struct Direction {
  float cosine;
  float sine;
};

// Direction of the connecting line as one of four sectors of a half turn; `reversed` if the pair must be swapped.
struct Sector {
  std::uint32_t number;
  bool reversed;
};

Sector QuantiseDirection(float along, float across) {
  constexpr float kTan = 0.41421356F;  // of 22.5 degrees: sectors are centred on the axes and the diagonals
  const float a = std::abs(along);
  const float b = std::abs(across);
  if (b < kTan * a) return {0, along < 0};
  if (a <= kTan * b) return {2, across < 0};
  return {(along > 0) == (across > 0) ? 1U : 3U, across < 0};
}

// Keypoint indices ordered by scale level, then by y, then by x.
std::vector<std::uint32_t> OrderByRow(std::span<const Keypoint> keypoints, std::span<const int> level) {
  std::vector<std::uint32_t> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {},
                    [&](std::uint32_t i) { return std::tuple(level[i], keypoints[i].y, keypoints[i].x, i); });
  return order;
}

// For each position in that order, the end of its row, i.e. of the keypoints of equal level and y.
std::vector<std::size_t> RowEnds(std::span<const Keypoint> keypoints, std::span<const int> level,
                                 std::span<const std::uint32_t> order) {
  std::vector<std::size_t> ends(order.size());
  for (std::size_t a = order.size(); a-- > 0;) {
    const bool last = a + 1 == order.size() || level[order[a]] != level[order[a + 1]] ||
                      keypoints[order[a]].y != keypoints[order[a + 1]].y;
    ends[a] = last ? a + 1 : ends[a + 1];
  }
  return ends;
}

}  // namespace

void PhraseOptions::ListFields(FieldList& fields) {
  fields.Add("word_clusters", word_clusters,
             {.min = 2, .max = 1024, .reason = "clusters of similar words, from which phrases are built"});
  fields.Add("weight", weight,
             {.min = 0, .max = 100, .reason = "weight of the phrase kernel relative to that of words"});
}

SparseVector Hellinger(SparseVector counts) {
  double sum = 0;
  for (const auto& [index, count] : counts) sum += count;
  for (auto& [index, count] : counts) count = static_cast<float>(std::sqrt(count / sum));
  return counts;
}

std::size_t PhraseCount(std::size_t word_clusters) { return word_clusters * word_clusters * kPhraseGeometryBins; }

std::vector<PhraseOccurrence> FindPhrases(const QuantisedImage& image, std::span<const std::uint16_t> cluster_of_word,
                                          std::size_t word_clusters) {
  const std::size_t count = image.size();
  std::vector<int> level(count);
  std::vector<std::uint32_t> cluster(count);
  std::vector<Direction> direction(count);
  for (std::size_t i = 0; i < count; ++i) {
    level[i] = SizeLevel(image.keypoints[i]);
    cluster[i] = cluster_of_word[image.NearestWord(i)];
    const float angle = image.keypoints[i].orientation_rad;
    direction[i] = {std::cos(angle), std::sin(angle)};
  }
  const std::vector<std::uint32_t> order = OrderByRow(image.keypoints, level);
  std::vector<float> x_of(count);
  for (std::size_t a = 0; a < count; ++a) x_of[a] = image.keypoints[order[a]].x;
  const std::vector<std::size_t> row_end = RowEnds(image.keypoints, level, order);

  std::vector<PhraseOccurrence> phrases;
  for (std::size_t a = 0; a < count; ++a) {
    const std::uint32_t i = order[a];
    const Keypoint& first = image.keypoints[i];
    const float cell_px = kCellsPerScale * first.scale_px;
    const auto squared = [&](double cells) { return static_cast<float>(cells * cells) * cell_px * cell_px; };
    const float min_distance2 = squared(kMinPhraseDistance_cells);
    const float far_distance2 = squared(kFarPhraseDistance_cells);
    const float max_distance2 = squared(kMaxPhraseDistance_cells);
    // Candidates: the rest of the keypoint's row, then in each row below it the interval inside the circle.
    std::size_t b = a + 1;
    for (std::size_t row_begin = a; row_begin < count; row_begin = row_end[row_begin]) {
      const std::uint32_t in_row = order[row_begin];
      const float dy = image.keypoints[in_row].y - first.y;
      if (level[in_row] != level[i] || dy * dy > max_distance2) break;
      const float reach = std::sqrt(max_distance2 - dy * dy);
      const std::size_t end = row_end[row_begin];
      if (row_begin != a) {
        b = static_cast<std::size_t>(std::lower_bound(x_of.begin() + static_cast<std::ptrdiff_t>(row_begin),
                                                      x_of.begin() + static_cast<std::ptrdiff_t>(end),
                                                      first.x - reach) -
                                     x_of.begin());
      }
      for (; b < end && x_of[b] <= first.x + reach; ++b) {
        const float dx = x_of[b] - first.x;
        const float distance2 = dx * dx + dy * dy;
        if (distance2 < min_distance2) continue;
        const std::uint32_t j = order[b];
        // Direction of the mean orientation, not normalised: the sector does not depend on its length.
        const float mean_x = direction[i].cosine + direction[j].cosine;
        const float mean_y = direction[i].sine + direction[j].sine;
        if (mean_x * mean_x + mean_y * mean_y < 1) continue;  // orientations more than 120 degrees apart
        const Sector sector = QuantiseDirection(dx * mean_x + dy * mean_y, dy * mean_x - dx * mean_y);
        const std::uint32_t geometry_bin = 2 * sector.number + (distance2 > far_distance2 ? 1 : 0);
        const std::uint32_t from = sector.reversed ? j : i;
        const std::uint32_t to = sector.reversed ? i : j;
        const auto pair = static_cast<std::uint32_t>(cluster[from] * word_clusters + cluster[to]);
        phrases.push_back({from, to, static_cast<std::uint32_t>(pair * kPhraseGeometryBins + geometry_bin)});
      }
    }
  }
  return phrases;
}

SparseVector CountPhrases(std::span<const PhraseOccurrence> phrases, std::size_t word_clusters) {
  std::vector<std::uint16_t> counts(PhraseCount(word_clusters));
  for (const PhraseOccurrence& phrase : phrases)
    if (counts[phrase.phrase] < 0xFFFF) ++counts[phrase.phrase];
  SparseVector sparse;
  for (std::uint32_t phrase = 0; phrase < counts.size(); ++phrase)
    if (counts[phrase] > 0) sparse.emplace_back(phrase, counts[phrase]);
  return sparse;
}

}  // namespace victorious
