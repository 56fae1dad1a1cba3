#include "victorious/category/linear/phrase_histogram.h"

#include <cmath>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

QuantisedImage RandomGrid(std::uint64_t seed, bool on_a_grid) {
  Random random(seed);
  QuantisedImage image{.width = 100, .height = 100};
  for (int i = 0; i < 80; ++i) {
    const auto place = [&] { return static_cast<float>(on_a_grid ? 6.0 * random.Below(16) : random.Uniform(0, 100)); };
    image.keypoints.push_back(
        {place(), place(), i % 2 == 0 ? 1.5F : 3.0F, on_a_grid ? 0.0F : static_cast<float>(random.Uniform(-3, 3))});
    image.assignments.push_back({random.Below(6), 1});
  }
  return image;
}

constexpr std::size_t kClusters = 3;
const std::vector<std::uint16_t> kClusterOfWord = {0, 1, 2, 0, 1, 2};

TEST(FindPhrases, AreAllPairsOfEqualScaleWithinRadius) {
  for (const bool on_a_grid : {true, false}) {
    const QuantisedImage image = RandomGrid(5, on_a_grid);
    std::set<std::pair<std::uint32_t, std::uint32_t>> found;
    for (const PhraseOccurrence& phrase : FindPhrases(image, kClusterOfWord, kClusters)) {
      EXPECT_TRUE(found.insert(std::minmax(phrase.i, phrase.j)).second) << "each once";
      EXPECT_LT(phrase.phrase, PhraseCount(kClusters));
    }
    for (std::uint32_t i = 0; i < image.size(); ++i) {
      for (std::uint32_t j = i + 1; j < image.size(); ++j) {
        const Keypoint& a = image.keypoints[i];
        const Keypoint& b = image.keypoints[j];
        const double cells = std::hypot(a.x - b.x, a.y - b.y) / (3 * a.scale_px);
        const bool alike = std::cos(a.orientation_rad - b.orientation_rad) >= -0.5;
        const bool expected =
            a.scale_px == b.scale_px && alike && cells >= kMinPhraseDistance_cells && cells <= kMaxPhraseDistance_cells;
        const bool on_the_edge =
            std::abs(cells - kMinPhraseDistance_cells) < 1e-4 || std::abs(cells - kMaxPhraseDistance_cells) < 1e-4;
        if (on_the_edge) continue;
        EXPECT_EQ(found.contains({i, j}), expected) << i << " " << j << " " << cells;
      }
    }
  }
}

TEST(FindPhrases, AreInvariantUnderRotation) {
  const QuantisedImage image = RandomGrid(7, false);
  QuantisedImage turned = image;
  for (Keypoint& keypoint : turned.keypoints) {
    const double c = std::cos(0.7);
    const double s = std::sin(0.7);
    keypoint = {static_cast<float>(c * keypoint.x - s * keypoint.y + 9),
                static_cast<float>(s * keypoint.x + c * keypoint.y), keypoint.scale_px,
                keypoint.orientation_rad + 0.7F};
  }
  const auto phrases_of = [](const QuantisedImage& of) {
    std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> phrases;
    for (const PhraseOccurrence& phrase : FindPhrases(of, kClusterOfWord, kClusters))
      phrases.insert({phrase.i, phrase.j, phrase.phrase});
    return phrases;
  };
  EXPECT_EQ(phrases_of(image), phrases_of(turned));
}

TEST(Hellinger, ComparesFractionsRegardlessOfTotal) {
  const SparseVector small = {{1, 1.0F}, {4, 3.0F}};
  const SparseVector large = {{1, 10.0F}, {4, 30.0F}};
  EXPECT_NEAR(Dot(Hellinger(small), Hellinger(large)), 1, 1e-6);
  EXPECT_EQ(Dot(Hellinger(small), {{2, 1.0F}}), 0);
  EXPECT_TRUE(Hellinger({}).empty());
}

}  // namespace
}  // namespace victorious
