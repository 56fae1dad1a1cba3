#include "victorious/object/features/descriptor_cells.h"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/types/feature_set.h"

namespace victorious {
namespace {

int Distance2(std::span<const std::int8_t> a, std::span<const std::int8_t> b) {
  int squared = 0;
  for (std::size_t i = 0; i < kernels::kShortBytes; ++i) squared += (a[i] - b[i]) * (a[i] - b[i]);
  return squared;
}

TEST(DescriptorCells, CentresAreDistinct) {
  std::set<std::vector<std::int8_t>> centres;
  for (std::size_t cell = 0; cell < kDescriptorCells; ++cell) {
    const std::span<const std::int8_t> centre = CellCentre(cell).first(kernels::kShortBytes);
    EXPECT_GE(*std::ranges::min_element(centre), -kernels::kShortCentre);
    centres.emplace(centre.begin(), centre.end());
  }
  EXPECT_EQ(centres.size(), kDescriptorCells);
}

TEST(DescriptorCells, EachDescriptorIsInTheCellOfTheNearestCentre) {
  Random random(1);
  std::vector<std::uint8_t> descriptors(40 * kDescriptorSize);
  for (std::uint8_t& byte : descriptors) byte = static_cast<std::uint8_t>(random.Below(90));
  const ShortDescriptors made = ShortenDescriptors(descriptors);
  EXPECT_EQ(made.rows, kernels::ShortenToQueries(descriptors));
  ASSERT_EQ(made.cells.size(), 40U);
  for (std::size_t i = 0; i < made.cells.size(); ++i) {
    const auto row = std::span(made.rows).subspan(i * kernels::kShortBytes, kernels::kShortBytes);
    int nearest = std::numeric_limits<int>::max();
    for (std::size_t cell = 0; cell < kDescriptorCells; ++cell) {
      nearest = std::min(nearest, Distance2(row, CellCentre(cell)));
    }
    EXPECT_LE(Distance2(row, CellCentre(made.cells[i])), nearest + 1);  // half distances are rounded
  }
}

TEST(DescriptorCells, NoDescriptors) {
  const ShortDescriptors made = ShortenDescriptors({});
  EXPECT_TRUE(made.rows.empty());
  EXPECT_TRUE(made.cells.empty());
}

}  // namespace
}  // namespace victorious
