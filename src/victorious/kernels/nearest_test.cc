#include "victorious/kernels/nearest.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "victorious/base/random.h"
#include "victorious/kernels/nearest_device.h"

namespace victorious::kernels {
namespace {

using FindTwo = void (*)(const PackedQueries&, const PackedDescriptors&, std::span<NearestTwo>);
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

// Opened once for all tests.
struct OpenedDevice {
  std::string why_not;
  std::shared_ptr<NearestDevice> device = OpenNearestDevice(why_not);  ///< null: none
};
const OpenedDevice& Opened() {
  static const OpenedDevice opened;
  return opened;
}

// The queries from `first` on.
PackedQueries Part(const PackedQueries& queries, std::size_t first, std::size_t count) {
  const auto rows = std::span(queries.rows).subspan(first * kDescriptorBytes, count * kDescriptorBytes);
  const auto squared = std::span(queries.squared).subspan(first, count);
  return {count, {rows.begin(), rows.end()}, {squared.begin(), squared.end()}};
}

// The queries as two templates, of which the second may be empty.
void FindNearestKOnDevice(const PackedQueries& queries, const PackedDescriptors& set, std::size_t k,
                          std::span<Neighbour> out) {
  const std::size_t half = (queries.count + 1) / 2;
  NearestDevice& device = *Opened().device;
  const auto on_device = device.Upload(std::vector{Part(queries, 0, half), Part(queries, half, queries.count - half)});
  const auto set_there = device.Upload(set);
  ASSERT_TRUE(on_device && set_there && device.FindNearestK(*on_device, *set_there, k, out)) << device.last_error();
}

void FindNearestTwoOnDevice(const PackedQueries& queries, const PackedDescriptors& set, std::span<NearestTwo> out) {
  std::vector<Neighbour> two(2 * queries.count);
  FindNearestKOnDevice(queries, set, 2, two);
  for (std::size_t i = 0; i < queries.count; ++i) {
    out[i] = {two[2 * i].index, two[2 * i].distance2, two[2 * i + 1].distance2};
  }
}

struct Implementation {
  std::string name;
  FindTwo find;
  FindK find_k;
  std::int64_t highway_target = 0;  ///< the only instruction set that Highway may use; 0: Highway's choice

  friend std::ostream& operator<<(std::ostream& out, const Implementation& one) { return out << one.name; }
};

// The reference, VNNI, the CUDA device, the dispatched one, and Highway's code for every instruction set of this
// machine.
std::vector<Implementation> Implementations() {
  std::vector<Implementation> all = {{"ref", &FindNearestTwoRef, &FindNearestKRef},
                                     {"vnni", &FindNearestTwoVnni, &FindNearestKVnni},
                                     {"device", &FindNearestTwoOnDevice, &FindNearestKOnDevice},
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
    if (GetParam().name == "device" && !Opened().device) GTEST_SKIP() << "SKIPPED: " << Opened().why_not;
    LetHighwayChooseFrom(GetParam().highway_target);
  }
  void TearDown() override { LetHighwayChooseFrom(0); }

  void Check(const std::vector<std::uint8_t>& queries, const std::vector<std::uint8_t>& set) {
    const PackedQueries packed = PackQueries(queries);
    std::vector<NearestTwo> out(packed.count);
    GetParam().find(packed, Pack(set), out);
    EXPECT_EQ(out, Expected(queries, set))
        << packed.count << " queries, " << set.size() / kDescriptorBytes << " in set";
    for (const std::size_t k : {std::size_t{1}, std::size_t{3}, std::size_t{4}, kMaxNeighbours}) {
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

TEST_P(NearestTest, MatchesReferenceInALargeSet) {
  Random random(9);
  Check(RandomRows(random, 300, 256), RandomRows(random, 1'500, 256));
  // Of two levels: many equal distances, at any places of the set.
  for (const std::size_t queries : {127, 128, 129}) {
    Check(RandomRows(random, queries, 2), RandomRows(random, 700, 2));
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

TEST_P(NearestTest, ServesSeveralThreads) {
  Random random(10);
  const std::vector<std::uint8_t> queries = RandomRows(random, 200, 256);
  std::vector<std::vector<std::uint8_t>> sets;
  for (const std::size_t count : {900, 100, 500, 1'300}) sets.push_back(RandomRows(random, count, 256));
  std::vector<std::vector<Neighbour>> found(sets.size(), std::vector<Neighbour>(std::size_t{200} * 4));
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      threads.emplace_back([&, i] {
        for (int repetition = 0; repetition < 3; ++repetition) {
          GetParam().find_k(PackQueries(queries), Pack(sets[i]), 4, found[i]);
        }
      });
    }
  }
  for (std::size_t i = 0; i < sets.size(); ++i) EXPECT_EQ(found[i], ExpectedK(queries, sets[i], 4)) << i;
}

INSTANTIATE_TEST_SUITE_P(Implementations, NearestTest, ::testing::ValuesIn(Implementations()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace victorious::kernels
