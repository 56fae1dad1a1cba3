#include "victorious/kernels/short_nearest.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/nearest.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

using FindShort = void (*)(std::span<const std::int8_t* const>, const ShortSet&, std::size_t,
                           std::span<const QueryBlocks>, std::span<std::uint32_t>);
using Compute = void (*)(std::span<const std::int8_t>, const ShortSet&, std::span<std::int32_t>);

constexpr std::uint32_t kLevels = 128;  // of a shortened descriptor's values

std::vector<std::uint8_t> RandomShortRows(Random& random, std::size_t count, std::uint32_t levels) {
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

// Over odd sizes, ranges, ties and extreme values.
void ExpectReference(FindShort find, Compute compute) {
  Random random(9);
  for (const std::uint32_t levels : {1U, 2U, kLevels}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{15}, std::size_t{33}, std::size_t{400}, kMaxShortSet}) {
      const ShortSet set = PackShort(RandomShortRows(random, count, levels));
      const std::vector<std::int8_t> queries = Centred(RandomShortRows(random, 5, std::min(levels + 1, kLevels)));
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
        find(RowsOf(queries), set, k, ranges, out);
        EXPECT_EQ(out, expected) << k << " of " << count << ", " << levels << " levels";
      }
      std::vector<std::int32_t> expected(set.half_constant.size());
      std::vector<std::int32_t> out(set.half_constant.size());
      ComputeHalfDistancesRef(std::span(queries).first(kShortBytes), set, expected);
      compute(std::span(queries).first(kShortBytes), set, out);
      EXPECT_EQ(out, expected);
    }
  }
}

class ShortNearestTest : public TargetTest {};

TEST_P(ShortNearestTest, MatchesReference) { ExpectReference(&FindShortNearestSimd, &ComputeHalfDistancesSimd); }

VICTORIOUS_EVERY_TARGET(ShortNearestTest);

TEST(ShortNearest, DispatchedMatchesReference) { ExpectReference(&FindShortNearest, &ComputeHalfDistances); }

TEST(ShortNearest, VnniMatchesReference) {
  if (!HasVnni()) GTEST_SKIP() << "SKIPPED: no AVX-512 VNNI here";
  ExpectReference(&FindShortNearestVnni, &ComputeHalfDistances);
}

// The reference itself: half distances differ as half the squared distances do, up to rounding.
TEST(ShortNearest, HalfDistancesAreDistances) {
  Random random(10);
  const std::vector<std::uint8_t> rows = RandomShortRows(random, 50, kLevels);
  const std::vector<std::uint8_t> query = RandomShortRows(random, 1, kLevels);
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

TEST(ShortNearest, SelectsAsIfPackedFromTheirRows) {
  Random random(11);
  const std::vector<std::uint8_t> rows = RandomShortRows(random, 70, kLevels);
  const std::vector<std::uint32_t> numbers = {69, 0, 15, 16, 17, 3, 3, 40, 41, 2, 68, 30, 31, 32, 33, 34, 35};
  std::vector<std::uint8_t> selected_rows;
  for (const std::uint32_t number : numbers) {
    const auto row = std::span(rows).subspan(number * kShortBytes, kShortBytes);
    selected_rows.insert(selected_rows.end(), row.begin(), row.end());
  }
  const ShortSet selected = SelectShort(PackShort(rows), numbers);
  const ShortSet packed = PackShort(selected_rows);
  EXPECT_EQ(selected.count, numbers.size());
  EXPECT_EQ(selected.blocks, packed.blocks);
  EXPECT_EQ(selected.half_constant, packed.half_constant);
}

// The nearest is found, and the third nearest of one lane is not.
TEST(ShortNearest, ConsidersTwoOfEachLane) {
  std::vector<std::uint8_t> rows(4 * kBlockDescriptors * kShortBytes, 100);
  const auto paint = [&](std::size_t row, std::uint8_t value) {
    std::fill_n(rows.begin() + static_cast<std::ptrdiff_t>(row * kShortBytes), kShortBytes, value);
  };
  paint(5, 3);  // three in one lane, and a farther one in another
  paint(5 + kBlockDescriptors, 2);
  paint(5 + 2 * kBlockDescriptors, 1);
  paint(6, 50);
  const std::vector<std::int8_t> query = Centred(std::vector<std::uint8_t>(kShortBytes, 0));
  const std::vector<QueryBlocks> blocks = {{{0, 4}, {}}};
  std::vector<std::uint32_t> out(3);
  FindShortNearestRef(RowsOf(query), PackShort(rows), 3, blocks, out);
  EXPECT_EQ(out, (std::vector<std::uint32_t>{5 + 2 * kBlockDescriptors, 5 + kBlockDescriptors, 6}));
}

}  // namespace
}  // namespace victorious::kernels
