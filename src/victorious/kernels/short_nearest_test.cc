#include "victorious/kernels/short_nearest.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "victorious/base/random.h"
#include "victorious/kernels/nearest.h"

namespace victorious::kernels {
namespace {

using Find = void (*)(std::span<const std::int8_t* const>, const ShortSet&, std::size_t, std::span<const QueryBlocks>,
                      std::span<std::uint32_t>);
using Compute = void (*)(std::span<const std::int8_t>, const ShortSet&, std::span<std::int32_t>);

constexpr std::uint32_t kLevels = 128;  // of a shortened descriptor's values

std::vector<std::uint8_t> RandomRows(Random& random, std::size_t count, std::uint32_t levels) {
  std::vector<std::uint8_t> rows(count * kShortBytes);
  for (std::uint8_t& byte : rows) {
    byte = static_cast<std::uint8_t>(random.Below(levels) * (kLevels - 1) / std::max(1U, levels - 1));
  }
  return rows;
}

std::vector<std::int8_t> Centred(const std::vector<std::uint8_t>& rows) {
  std::vector<std::int8_t> queries(rows.size());
  std::ranges::transform(rows, queries.begin(),
                         [](std::uint8_t value) { return static_cast<std::int8_t>(value - kShortCentre); });
  return queries;
}

std::vector<const std::int8_t*> RowsOf(const std::vector<std::int8_t>& queries) {
  std::vector<const std::int8_t*> rows;
  for (std::size_t i = 0; i < queries.size(); i += kShortBytes) rows.push_back(&queries[i]);
  return rows;
}

struct Implementation {
  std::string name;
  Find find;
  Compute compute;
  std::int64_t highway_target = 0;  ///< the only instruction set that Highway may use; 0: Highway's choice

  friend std::ostream& operator<<(std::ostream& out, const Implementation& one) { return out << one.name; }
};

// VNNI, the dispatched one, and Highway's code for every instruction set of this machine.
std::vector<Implementation> Implementations() {
  std::vector<Implementation> all = {{"vnni", &FindShortNearestVnni, &ComputeHalfDistances},
                                     {"best", &FindShortNearest, &ComputeHalfDistances}};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    std::string name = "simd_" + std::string(hwy::TargetName(target));
    std::erase_if(name, [](unsigned char c) { return c != '_' && std::isalnum(c) == 0; });
    all.push_back({std::move(name), &FindShortNearestSimd, &ComputeHalfDistancesSimd, target});
  }
  return all;
}

// Mask 0 restores Highway's own choice.
void LetHighwayChooseFrom(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();  // the next call dispatches again
}

class ShortNearestTest : public ::testing::TestWithParam<Implementation> {
 protected:
  void SetUp() override {
    if (GetParam().name == "vnni" && !HasVnni()) GTEST_SKIP() << "SKIPPED: no AVX-512 VNNI here";
    LetHighwayChooseFrom(GetParam().highway_target);
  }
  void TearDown() override { LetHighwayChooseFrom(0); }
};

// Over odd sizes, ranges, ties and extreme values.
TEST_P(ShortNearestTest, MatchesReference) {
  Random random(9);
  for (const std::uint32_t levels : {1U, 2U, kLevels}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{15}, std::size_t{33}, std::size_t{400}, kMaxShortSet}) {
      const ShortSet set = PackShort(RandomRows(random, count, levels));
      const std::vector<std::int8_t> queries = Centred(RandomRows(random, 5, std::min(levels + 1, kLevels)));
      const std::size_t blocks = set.block_count();
      const std::vector<QueryBlocks> ranges = {{{0, blocks}, {}},
                                               {{blocks / 2, blocks}, {}},
                                               {{0, blocks / 3}, {blocks - 1, blocks}},
                                               {{}, {}},
                                               {{}, {blocks / 2, blocks}}};
      for (const std::size_t k : {std::size_t{1}, std::size_t{4}, kMaxShortNeighbours}) {
        std::vector<std::uint32_t> expected(ranges.size() * k);
        std::vector<std::uint32_t> out(ranges.size() * k);
        FindShortNearestRef(RowsOf(queries), set, k, ranges, expected);
        GetParam().find(RowsOf(queries), set, k, ranges, out);
        EXPECT_EQ(out, expected) << k << " of " << count << ", " << levels << " levels";
      }
      std::vector<std::int32_t> expected(set.half_constant.size());
      std::vector<std::int32_t> out(set.half_constant.size());
      ComputeHalfDistancesRef(std::span(queries).first(kShortBytes), set, expected);
      GetParam().compute(std::span(queries).first(kShortBytes), set, out);
      EXPECT_EQ(out, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Implementations, ShortNearestTest, ::testing::ValuesIn(Implementations()),
                         [](const auto& test) { return test.param.name; });

// The reference itself: half distances differ as half the squared distances do, up to rounding.
TEST(ShortNearest, HalfDistancesAreDistances) {
  Random random(10);
  const std::vector<std::uint8_t> rows = RandomRows(random, 50, kLevels);
  const std::vector<std::uint8_t> query = RandomRows(random, 1, kLevels);
  const ShortSet set = PackShort(rows);
  std::vector<std::int32_t> half_distances(set.half_constant.size());
  ComputeHalfDistancesRef(Centred(query), set, half_distances);
  std::int32_t query_squared = 0;
  for (const std::uint8_t value : query) query_squared += value * value;
  for (std::size_t i = 0; i < set.count; ++i) {
    std::int32_t squared = 0;
    for (std::size_t k = 0; k < kShortBytes; ++k) {
      const int difference = rows[i * kShortBytes + k] - query[k];
      squared += difference * difference;
    }
    EXPECT_NEAR(half_distances[i], (squared - query_squared) / 2.0, 0.5) << i;
  }
  EXPECT_EQ(half_distances.back(), kShortPadding);
}

// The nearest is found, and the third nearest of one lane is not.
TEST(ShortNearest, ConsidersTwoOfEachLane) {
  std::vector<std::uint8_t> rows(4 * kShortBlock * kShortBytes, 100);
  const auto paint = [&](std::size_t row, std::uint8_t value) {
    std::fill_n(rows.begin() + static_cast<std::ptrdiff_t>(row * kShortBytes), kShortBytes, value);
  };
  paint(5, 3);  // three in one lane, and a farther one in another
  paint(5 + kShortBlock, 2);
  paint(5 + 2 * kShortBlock, 1);
  paint(6, 50);
  const std::vector<std::int8_t> query = Centred(std::vector<std::uint8_t>(kShortBytes, 0));
  const std::vector<QueryBlocks> blocks = {{{0, 4}, {}}};
  std::vector<std::uint32_t> out(3);
  FindShortNearestRef(RowsOf(query), PackShort(rows), 3, blocks, out);
  EXPECT_EQ(out, (std::vector<std::uint32_t>{5 + 2 * kShortBlock, 5 + kShortBlock, 6}));
}

}  // namespace
}  // namespace victorious::kernels
