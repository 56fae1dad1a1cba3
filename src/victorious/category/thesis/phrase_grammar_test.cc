#include "victorious/category/thesis/phrase_grammar.h"

#include <cmath>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/category/thesis/visit_pairs.h"
#include "victorious/geometry/pair_measures.h"

namespace victorious {
namespace {

QuantisedImage MakeImage(std::vector<Keypoint> keypoints, const std::vector<std::uint32_t>& words) {
  QuantisedImage image{.keypoints = std::move(keypoints), .width = 200, .height = 200};
  for (const std::uint32_t word : words) image.assignments.push_back({word, 1});
  return image;
}

QuantisedImage RandomImage(std::uint64_t seed, std::size_t keypoints, std::uint32_t words) {
  Random random(seed);
  QuantisedImage image{.width = 200, .height = 200};
  for (std::size_t i = 0; i < keypoints; ++i) {
    image.keypoints.push_back({static_cast<float>(random.Uniform(0, 200)), static_cast<float>(random.Uniform(0, 200)),
                               static_cast<float>(random.Uniform(1, 6)), static_cast<float>(random.Uniform(-3, 3))});
    image.assignments.push_back({random.Below(words), 1});
  }
  return image;
}

TEST(CellKernel, EqualsEquation31AveragedOverACell) {
  constexpr double kCap = 10000;
  constexpr double kWidth = 5.0 / kMeasureCells;  // cell width of the scale ratio
  for (const int cells : {0, 1, 7}) {
    double sum = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
      const double x = (cells - 0.5 + (i + 0.5) / kSteps) * kWidth;
      sum += std::min(1 / (x * x), kCap);
    }
    EXPECT_NEAR(CellKernel(0, cells, kCap) / (sum / kSteps), 1, 1e-4) << cells;
  }
}

TEST(VisitPairs, FindsEachPairWithinTheRadiusOnce) {
  const QuantisedImage image = RandomImage(3, 60, 5);
  std::size_t expected = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
    for (std::size_t j = i + 1; j < image.size(); ++j)
      expected +=
          std::hypot(image.keypoints[i].x - image.keypoints[j].x, image.keypoints[i].y - image.keypoints[j].y) <= 50
              ? 1
              : 0;
  std::size_t found = 0;
  VisitPairs(image.keypoints, 50, [&](std::uint32_t i, std::uint32_t j) {
    EXPECT_LT(i, j);
    ++found;
  });
  EXPECT_EQ(found, expected);
}

// Equation 3.3 as in the thesis, a sum over every sample, with quantised measures.
double BruteForce(const std::vector<QuantisedImage>& training, const std::vector<float>& likelihoods,
                  const QuantisedImage& image, const GrammarOptions& options) {
  const auto measures_of = [&](const QuantisedImage& from, std::uint32_t a, std::uint32_t b) {
    const auto key = [&](std::uint32_t i) { return std::pair(from.NearestWord(i), -from.keypoints[i].scale_px); };
    if (key(b) < key(a)) std::swap(a, b);
    return std::tuple(from.NearestWord(a), from.NearestWord(b), QuantiseMeasures(from.keypoints[a], from.keypoints[b]));
  };
  double sum = 0;
  std::size_t pairs = 0;
  VisitPairs(image.keypoints, options.radius_px, [&](std::uint32_t i, std::uint32_t j) {
    ++pairs;
    const auto [w1, w2, cells] = measures_of(image, i, j);
    std::array<double, kMeasures> density{};
    int samples = 0;
    for (const QuantisedImage& from : training) {
      VisitPairs(from.keypoints, options.radius_px, [&](std::uint32_t a, std::uint32_t b) {
        const auto [v1, v2, other] = measures_of(from, a, b);
        if (v1 != w1 || v2 != w2) return;
        ++samples;
        for (std::size_t g = 0; g < kMeasures; ++g) {
          int apart = std::abs(cells[g] - other[g]);
          if (g >= 2) apart = std::min(apart, kMeasureCells - apart);
          density[g] += CellKernel(g, apart, options.kernel_cap);
        }
      });
    }
    if (samples == 0) return;
    double product = static_cast<double>(likelihoods[w1]) * likelihoods[w2];
    for (const double value : density) product *= value / samples;
    sum += product;
  });
  return sum / static_cast<double>(pairs);
}

TEST(PhraseGrammar, EqualsSumOverAllSamples) {
  // With decreasing likelihoods the order of W(z) is that of the vocabulary.
  const std::vector<float> likelihoods = {0.4F, 0.3F, 0.2F, 0.1F};
  const GrammarOptions options = {.word_fraction = 1};
  std::vector<QuantisedImage> training;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) training.push_back(RandomImage(seed, 40, 4));
  std::vector<const QuantisedImage*> pointers;
  for (const QuantisedImage& image : training) pointers.push_back(&image);
  const PhraseGrammar grammar = PhraseGrammar::Learn(pointers, likelihoods, options);
  const QuantisedImage image = RandomImage(77, 30, 4);
  const double expected = BruteForce(training, likelihoods, image, options);
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(grammar.Likelihood(image) / expected, 1, 1e-4);
}

TEST(PhraseGrammar, KeepsOnlyTheMostProbableWords) {
  const std::vector<float> likelihoods = {0.1F, 0.5F, 0.1F, 0.3F};
  const QuantisedImage image = RandomImage(1, 30, 4);
  const QuantisedImage* const pointer = &image;
  const PhraseGrammar grammar = PhraseGrammar::Learn(std::span(&pointer, 1), likelihoods, {.word_fraction = 0.5});
  EXPECT_EQ(std::vector(grammar.words().begin(), grammar.words().end()), (std::vector<std::uint32_t>{1, 3}));
}

TEST(PhraseGrammar, IsInvariantUnderTranslationRotationAndOrder) {
  const QuantisedImage training = RandomImage(1, 60, 3);
  const QuantisedImage* const pointer = &training;
  const PhraseGrammar grammar =
      PhraseGrammar::Learn(std::span(&pointer, 1), std::vector<float>(3, 0.33F), {.word_fraction = 1});
  const Keypoint a{50, 60, 2, 0.3F};
  const Keypoint b{70, 65, 3, 1.0F};
  const auto likelihood = [&](Keypoint i, Keypoint j, std::uint32_t wi, std::uint32_t wj) {
    return grammar.Likelihood(MakeImage({i, j}, {wi, wj}));
  };
  const double value = likelihood(a, b, 0, 1);
  EXPECT_DOUBLE_EQ(likelihood(b, a, 1, 0), value);
  // A rotation by 90 degrees about the origin and a translation.
  const auto turned = [](const Keypoint& k) {
    return Keypoint{-k.y + 150, k.x + 5, k.scale_px, k.orientation_rad + 1.5707963F};
  };
  EXPECT_NEAR(likelihood(turned(a), turned(b), 0, 1) / value, 1, 1e-3);
  EXPECT_EQ(grammar.Likelihood(MakeImage({a}, {0})), 0) << "no pair, no phrase";
  EXPECT_EQ(grammar.Likelihood(MakeImage({a, a}, {0, 1})), 0) << "no line between them";
}

}  // namespace
}  // namespace victorious
