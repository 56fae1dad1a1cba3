#include "victorious/kernels/descriptor_distance.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/descriptor.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

using Descriptor = std::array<std::uint8_t, kDescriptorBytes>;

TEST(ComputeDescriptorDistances, SumsSquaredDifferences) {
  Descriptor query{};
  Descriptor other{};
  query[0] = 3;
  other[127] = 4;
  std::uint32_t distance2 = 0;
  ComputeDescriptorDistancesRef(query.data(), std::array{static_cast<const std::uint8_t*>(other.data())},
                                {&distance2, 1});
  EXPECT_EQ(distance2, 25U);
}

class DescriptorDistance : public TargetTest {};

TEST_P(DescriptorDistance, EqualsTheReferenceAlsoOfExtremes) {
  Random random(11);
  std::vector<Descriptor> all(9);
  all[0].fill(0);
  all[1].fill(255);
  for (std::size_t i = 2; i < all.size(); ++i) {
    for (std::uint8_t& value : all[i]) value = static_cast<std::uint8_t>(random.Below(256));
  }
  std::vector<const std::uint8_t*> others;
  for (const Descriptor& one : all) others.push_back(one.data());
  for (const Descriptor& query : all) {
    std::vector<std::uint32_t> found(all.size());
    std::vector<std::uint32_t> expected(all.size());
    ComputeDescriptorDistances(query.data(), others, found);
    ComputeDescriptorDistancesRef(query.data(), others, expected);
    EXPECT_EQ(found, expected);
  }
}

VICTORIOUS_EVERY_TARGET(DescriptorDistance);

}  // namespace
}  // namespace victorious::kernels
