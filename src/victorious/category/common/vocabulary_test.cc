#include "victorious/category/common/vocabulary.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "victorious/base/random.h"

namespace victorious {
namespace {

// `per_cluster` descriptors near each of `clusters` well-separated centres.
std::vector<std::uint8_t> Clusters(std::size_t clusters, std::size_t per_cluster, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> rows;
  for (std::size_t i = 0; i < clusters * per_cluster; ++i)
    for (std::size_t k = 0; k < kDescriptorSize; ++k)
      rows.push_back(static_cast<std::uint8_t>((k % clusters == i % clusters ? 200 : 10) + random.Below(5)));
  return rows;
}

TEST(Vocabulary, FindsClusters) {
  constexpr std::size_t kClusters = 4;
  const auto rows = Clusters(kClusters, 50, 1);
  const Vocabulary vocabulary = Vocabulary::Learn(rows, {.words = kClusters, .root = false, .iterations = 30}, 3);
  const auto words = vocabulary.NearestWords(rows, 1);
  std::set<std::uint32_t> distinct;
  for (std::size_t i = 0; i < words.size(); ++i) {
    EXPECT_EQ(words[i].index, words[i % kClusters].index);
    distinct.insert(words[i].index);
  }
  EXPECT_EQ(distinct.size(), kClusters);
}

TEST(Vocabulary, IsDeterministicBySeed) {
  const auto rows = Clusters(7, 40, 2);
  const VocabularyOptions options = {.words = 20, .iterations = 5};
  const auto centres = [&](std::uint64_t seed) {
    const Vocabulary vocabulary = Vocabulary::Learn(rows, options, seed);
    return std::vector(vocabulary.centres().begin(), vocabulary.centres().end());
  };
  EXPECT_EQ(centres(5), centres(5));
  EXPECT_NE(centres(5), centres(6));
}

TEST(Vocabulary, HasNoMoreWordsThanDescriptors) {
  const auto rows = Clusters(3, 1, 1);
  EXPECT_EQ(Vocabulary::Learn(rows, {.words = 100}, 1).size(), 3U);
}

TEST(Vocabulary, KMeansReducesQuantisationError) {
  Random random(9);
  std::vector<std::uint8_t> rows(400 * kDescriptorSize);
  for (auto& value : rows) value = static_cast<std::uint8_t>(random.Below(256));
  const auto cost = [&](int iterations) {
    const Vocabulary vocabulary = Vocabulary::Learn(rows, {.words = 30, .root = false, .iterations = iterations}, 1);
    double sum = 0;
    for (const auto& word : vocabulary.NearestWords(rows, 1)) sum += word.distance2;
    return sum;
  };
  EXPECT_LT(cost(10), cost(1));
}

TEST(RootDescriptors, HaveUnitLengthAndIgnoreContrast) {
  std::vector<std::uint8_t> row(kDescriptorSize, 0);
  row[3] = 100;
  row[5] = 25;
  std::vector<std::uint8_t> fainter = row;
  fainter[3] = 40;
  fainter[5] = 10;
  EXPECT_EQ(RootDescriptors(row), RootDescriptors(fainter));
  EXPECT_EQ(RootDescriptors(row)[5], 229);  // 512 sqrt(25 / 125)
  EXPECT_EQ(RootDescriptors(row)[0], 0);
}

}  // namespace
}  // namespace victorious
