#include "victorious/category/histogram.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "victorious/geometry/angles.h"

namespace victorious {
namespace {

// Keypoints of one size have one level: a factor of 1.5 apart, as far as sizes of DenseFeatures are.
int SizeLevel(const Keypoint& keypoint) {
  constexpr double kLevelsPerNat = 2.466;  // 1 / ln 1.5
  return static_cast<int>(std::lround(std::log(keypoint.scale_px) * kLevelsPerNat));
}

constexpr float kCellsPerScale = 3;  // a descriptor's cell is 3 sigma wide

struct Direction {
  float cosine;
  float sine;
};

// Which of four sectors of a half turn the line lies in, and whether the pair must be turned round to get it there.
struct Sector {
  std::uint32_t number;
  bool reversed;
};

Sector SectorOf(float along, float across) {
  constexpr float kTan = 0.41421356F;  // of 22.5 degrees: sectors are about the axes and the diagonals
  const float a = std::abs(along);
  const float b = std::abs(across);
  if (b < kTan * a) return {0, along < 0};
  if (a <= kTan * b) return {2, across < 0};
  return {(along > 0) == (across > 0) ? 1U : 3U, across < 0};
}

}  // namespace

void PhraseOptions::ListFields(FieldList& fields) {
  fields.Add("parts", parts,
             {.min = 2, .max = 1024, .reason = "groups of words that look alike, which phrases are of"});
  fields.Add("nearest_cells", nearest_cells,
             {.min = 0, .max = 100, .unit = "cells", .reason = "nearer pairs share pixels: no phrase"});
  fields.Add("far_cells", far_cells,
             {.min = 0, .max = 100, .unit = "cells", .reason = "from here on the two words are far, not near"});
  fields.Add("farthest_cells", farthest_cells,
             {.min = 0, .max = 100, .unit = "cells", .reason = "pairs farther apart make no phrase (R of the thesis)"});
  fields.Add("weight", weight,
             {.min = 0, .max = 100, .reason = "of phrases against words in the comparison of two pictures"});
}

double Dot(const SparseVector& a, const SparseVector& b) {
  double sum = 0;
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (i->first == j->first) {
      sum += static_cast<double>(i->second) * j->second;
      ++i;
      ++j;
    } else if (i->first < j->first) {
      ++i;
    } else {
      ++j;
    }
  }
  return sum;
}

SparseVector CountWords(const WordedPicture& picture, std::size_t words) {
  std::vector<float> counts(words);
  for (const WordShare& share : picture.shares) counts[share.word] += share.share;
  SparseVector sparse;
  for (std::uint32_t word = 0; word < words; ++word)
    if (counts[word] > 0) sparse.emplace_back(word, counts[word]);
  return sparse;
}

SparseVector Hellinger(SparseVector counts) {
  double sum = 0;
  for (const auto& [index, count] : counts) sum += count;
  for (auto& [index, count] : counts) count = static_cast<float>(std::sqrt(count / sum));
  return counts;
}

std::size_t PhraseCount(std::size_t parts) { return parts * parts * kPlacesOfPhrase; }

std::vector<PhraseOccurrence> FindPhrases(const WordedPicture& picture, std::span<const std::uint16_t> part_of_word,
                                          std::size_t parts, const PhraseOptions& options) {
  const std::size_t count = picture.size();
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::vector<int> level(count);
  for (std::size_t i = 0; i < count; ++i) level[i] = SizeLevel(picture.keypoints[i]);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return std::pair(level[i], picture.keypoints[i].y); });
  std::vector<std::uint32_t> part(count);
  std::vector<Direction> direction(count);
  for (std::size_t i = 0; i < count; ++i) {
    part[i] = part_of_word[picture.Word(i)];
    const float angle = picture.keypoints[i].orientation_rad;
    direction[i] = {std::cos(angle), std::sin(angle)};
  }
  std::vector<PhraseOccurrence> phrases;
  for (std::size_t a = 0; a < count; ++a) {
    const std::uint32_t i = order[a];
    const Keypoint& first = picture.keypoints[i];
    const float cell_px = kCellsPerScale * first.scale_px;
    const float nearest2 = std::pow(static_cast<float>(options.nearest_cells) * cell_px, 2.0F);
    const float far2 = std::pow(static_cast<float>(options.far_cells) * cell_px, 2.0F);
    const float farthest = static_cast<float>(options.farthest_cells) * cell_px;
    for (std::size_t b = a + 1; b < count; ++b) {
      const std::uint32_t j = order[b];
      const Keypoint& second = picture.keypoints[j];
      const float dy = second.y - first.y;
      if (dy > farthest || level[j] != level[i]) break;
      const float dx = second.x - first.x;
      const float distance2 = dx * dx + dy * dy;
      if (distance2 > farthest * farthest || distance2 < nearest2) continue;
      // The mean orientation's direction, up to its length, which the sector does not depend on.
      const float mean_x = direction[i].cosine + direction[j].cosine;
      const float mean_y = direction[i].sine + direction[j].sine;
      if (mean_x * mean_x + mean_y * mean_y < 1) continue;  // orientations more than 120 degrees apart
      const Sector sector = SectorOf(dx * mean_x + dy * mean_y, dy * mean_x - dx * mean_y);
      const std::uint32_t place = 2 * sector.number + (distance2 > far2 ? 1 : 0);
      const std::uint32_t from = sector.reversed ? j : i;
      const std::uint32_t to = sector.reversed ? i : j;
      const auto pair = static_cast<std::uint32_t>(part[from] * parts + part[to]);
      phrases.push_back({from, to, static_cast<std::uint32_t>(pair * kPlacesOfPhrase + place)});
    }
  }
  return phrases;
}

SparseVector CountPhrases(std::span<const PhraseOccurrence> phrases, std::size_t parts) {
  std::vector<std::uint16_t> counts(PhraseCount(parts));
  for (const PhraseOccurrence& phrase : phrases)
    if (counts[phrase.phrase] < 0xFFFF) ++counts[phrase.phrase];
  SparseVector sparse;
  for (std::uint32_t phrase = 0; phrase < counts.size(); ++phrase)
    if (counts[phrase] > 0) sparse.emplace_back(phrase, counts[phrase]);
  return sparse;
}

}  // namespace victorious
