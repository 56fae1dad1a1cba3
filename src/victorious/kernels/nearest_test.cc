#include "victorious/kernels/nearest.h"

#include <algorithm>
#include <cctype>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "victorious/base/random.h"

namespace victorious::kernels {
namespace {

using Find = void (*)(const PackedQueries&, const PackedDescriptors&, std::span<NearestTwo>);
using FindK = void (*)(const PackedQueries&, const PackedDescriptors&, std::size_t, std::span<Neighbour>);
using FindShort = void (*)(const PackedQueries&, const PackedDescriptors&, std::size_t, std::span<const BlockRange>,
                           std::span<std::uint32_t>);

std::vector<std::uint8_t> RandomRows(Random& random, std::size_t count, std::uint32_t levels) {
  std::vector<std::uint8_t> rows(count * kDescriptorBytes);
  for (std::uint8_t& byte : rows) byte = static_cast<std::uint8_t>(random.Below(levels));
  return rows;
}

// Computed from the unpacked rows, so that the test covers packing, too.
std::vector<NearestTwo> Expected(const std::vector<std::uint8_t>& queries, const std::vector<std::uint8_t>& set) {
  std::vector<NearestTwo> result(queries.size() / kDescriptorBytes);
  for (std::size_t q = 0; q < result.size(); ++q) {
    for (std::size_t i = 0; i < set.size() / kDescriptorBytes; ++i) {
      std::uint32_t distance2 = 0;
      for (std::size_t k = 0; k < kDescriptorBytes; ++k) {
        const int difference = queries[q * kDescriptorBytes + k] - set[i * kDescriptorBytes + k];
        distance2 += static_cast<std::uint32_t>(difference * difference);
      }
      NearestTwo& nearest = result[q];
      if (distance2 < nearest.best_distance2) {
        nearest = {static_cast<std::uint32_t>(i), distance2, nearest.best_distance2};
      } else {
        nearest.second_distance2 = std::min(nearest.second_distance2, distance2);
      }
    }
  }
  return result;
}

std::vector<Neighbour> ExpectedK(std::span<const std::uint8_t> queries, std::span<const std::uint8_t> set,
                                 std::size_t k) {
  std::vector<Neighbour> result;
  for (std::size_t q = 0; q < queries.size() / kDescriptorBytes; ++q) {
    const std::span<const std::uint8_t> query = queries.subspan(q * kDescriptorBytes, kDescriptorBytes);
    std::vector<Neighbour> all(std::max(k, set.size() / kDescriptorBytes));
    for (std::size_t i = 0; i < set.size() / kDescriptorBytes; ++i) {
      all[i] = {static_cast<std::uint32_t>(i), 0};
      for (std::size_t byte = 0; byte < kDescriptorBytes; ++byte) {
        const int difference = query[byte] - set[i * kDescriptorBytes + byte];
        all[i].distance2 += static_cast<std::uint32_t>(difference * difference);
      }
    }
    std::ranges::stable_sort(all, {}, &Neighbour::distance2);
    result.insert(result.end(), all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k));
  }
  return result;
}

struct Implementation {
  std::string name;
  Find find;
  FindK find_k;
  FindShort find_short;
  std::int64_t highway_target = 0;  ///< the only instruction set that Highway may use; 0: Highway's choice

  friend std::ostream& operator<<(std::ostream& out, const Implementation& one) { return out << one.name; }
};

// The reference, VNNI, the dispatched one, and Highway's code for every instruction set of this machine.
std::vector<Implementation> Implementations() {
  std::vector<Implementation> all = {{"ref", &FindNearestTwoRef, &FindNearestKRef, &FindShortNearestRef},
                                     {"vnni", &FindNearestTwoVnni, &FindNearestKVnni, &FindShortNearestVnni},
                                     {"best", &FindNearestTwo, &FindNearestK, &FindShortNearest}};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    std::string name = "simd_" + std::string(hwy::TargetName(target));
    std::erase_if(name, [](unsigned char c) { return c != '_' && std::isalnum(c) == 0; });
    all.push_back({std::move(name), &FindNearestTwoSimd, &FindNearestKSimd, &FindShortNearestSimd, target});
  }
  return all;
}

// Mask 0 restores Highway's own choice.
void LetHighwayChooseFrom(std::int64_t targets) {
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();  // the next call dispatches again
}

class NearestTest : public ::testing::TestWithParam<Implementation> {
 protected:
  void SetUp() override {
    if (GetParam().name == "vnni" && !HasVnni()) GTEST_SKIP() << "SKIPPED: no AVX-512 VNNI here";
    LetHighwayChooseFrom(GetParam().highway_target);
  }
  void TearDown() override { LetHighwayChooseFrom(0); }

  void Check(const std::vector<std::uint8_t>& queries, const std::vector<std::uint8_t>& set) {
    const PackedQueries packed = PackQueries(queries);
    std::vector<NearestTwo> out(packed.count);
    GetParam().find(packed, Pack(set), out);
    EXPECT_EQ(out, Expected(queries, set))
        << packed.count << " queries, " << set.size() / kDescriptorBytes << " in set";
    for (const std::size_t k : {std::size_t{1}, std::size_t{3}, kMaxNeighbours}) {
      std::vector<Neighbour> neighbours(packed.count * k);
      GetParam().find_k(packed, Pack(set), k, neighbours);
      EXPECT_EQ(neighbours, ExpectedK(queries, set, k)) << k << " of " << set.size() / kDescriptorBytes;
    }
  }
};

TEST_P(NearestTest, MatchesReferenceOverOddSizes) {
  Random random(7);
  for (const std::size_t queries : {1, 3, 8, 9, 31}) {
    for (const std::size_t set : {0, 1, 2, 15, 16, 17, 33, 100}) {
      Check(RandomRows(random, queries, 256), RandomRows(random, set, 256));
    }
  }
}

TEST_P(NearestTest, BreaksTiesByLowestIndex) {
  Random random(8);
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::vector<std::uint8_t> set = RandomRows(random, 1, 256);
    const std::vector<std::uint8_t> one = set;
    for (int copy = 0; copy < 40; ++copy) set.insert(set.end(), one.begin(), one.end());
    Check(RandomRows(random, 5, 256), set);
  }
}

TEST_P(NearestTest, IsExactAtTheExtremes) {
  const std::vector<std::uint8_t> black(kDescriptorBytes * 20, 0);
  const std::vector<std::uint8_t> white(kDescriptorBytes * 20, 255);
  Check(black, white);
  Check(white, black);
  Check(white, white);
  Check(black, black);
}

// Short rows: as the reference over odd sizes, ranges, extremes and ties, and for a range of several segments.
TEST_P(NearestTest, ShortNearestMatchesReference) {
  Random random(9);
  for (const std::uint32_t levels : {1U, 2U, 256U}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{15}, std::size_t{33}, std::size_t{400},
                                    (2 * kSegmentBlocks + 1) * kBlockDescriptors - 3}) {
      if (count > 1000 && levels != 2) continue;
      const std::size_t queries = count > 1000 ? 3 : 3 * kRangeQueries + 5;
      std::vector<std::uint8_t> set = RandomRows(random, count / 4 + 1, levels);
      set.resize(count * kShortBytes);
      for (std::uint8_t& byte : set) byte = static_cast<std::uint8_t>(levels == 2 ? 255 * byte : byte);
      std::vector<std::uint8_t> rows = RandomRows(random, queries / 4 + 1, 256);
      rows.resize(queries * kShortBytes);
      const PackedDescriptors packed = Pack(set, kShortBytes);
      const std::size_t blocks = packed.block_count();
      const std::vector<BlockRange> ranges = {{0, blocks}, {blocks / 2, blocks}, {blocks - 1, blocks}, {0, 0}};
      for (const std::size_t k : {std::size_t{1}, std::size_t{4}, kMaxNeighbours}) {
        std::vector<std::uint32_t> expected(queries * k);
        std::vector<std::uint32_t> out(queries * k);
        FindShortNearestRef(PackQueries(rows, kShortBytes), packed, k, ranges, expected);
        GetParam().find_short(PackQueries(rows, kShortBytes), packed, k, ranges, out);
        EXPECT_EQ(out, expected) << k << " of " << count << ", " << levels << " levels";
      }
    }
  }
}

// The reference itself: the nearest is found, and the third nearest of one lane is not.
TEST(ShortNearest, ConsidersTwoOfEachLane) {
  std::vector<std::uint8_t> set(4 * kBlockDescriptors * kShortBytes, 200);
  const auto paint = [&](std::size_t row, std::uint8_t value) {
    std::fill_n(set.begin() + static_cast<std::ptrdiff_t>(row * kShortBytes), kShortBytes, value);
  };
  paint(5, 3);  // three in one lane, and a farther one in another
  paint(5 + kBlockDescriptors, 2);
  paint(5 + 2 * kBlockDescriptors, 1);
  paint(6, 50);
  const std::vector<std::uint8_t> query(kShortBytes, 0);
  const std::vector<BlockRange> ranges = {{0, 4}};
  std::vector<std::uint32_t> out(3);
  FindShortNearestRef(PackQueries(query, kShortBytes), Pack(set, kShortBytes), 3, ranges, out);
  EXPECT_EQ(out, (std::vector<std::uint32_t>{5 + 2 * kBlockDescriptors, 5 + kBlockDescriptors, 6}));
}

INSTANTIATE_TEST_SUITE_P(Implementations, NearestTest, ::testing::ValuesIn(Implementations()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace victorious::kernels
