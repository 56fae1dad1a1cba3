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
  std::int64_t highway_target = 0;  ///< the only instruction set that Highway may use; 0: Highway's choice

  friend std::ostream& operator<<(std::ostream& out, const Implementation& one) { return out << one.name; }
};

// The reference, VNNI, the dispatched one, and Highway's code for every instruction set of this machine.
std::vector<Implementation> Implementations() {
  std::vector<Implementation> all = {{"ref", &FindNearestTwoRef, &FindNearestKRef},
                                     {"vnni", &FindNearestTwoVnni, &FindNearestKVnni},
                                     {"best", &FindNearestTwo, &FindNearestK}};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    std::string name = "simd_" + std::string(hwy::TargetName(target));
    std::erase_if(name, [](unsigned char c) { return c != '_' && std::isalnum(c) == 0; });
    all.push_back({std::move(name), &FindNearestTwoSimd, &FindNearestKSimd, target});
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

INSTANTIATE_TEST_SUITE_P(Implementations, NearestTest, ::testing::ValuesIn(Implementations()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace victorious::kernels
