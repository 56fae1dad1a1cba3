#include "victorious/search/recognize/shape_templates.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::IsEmpty;

constexpr int kSide = 5;

std::vector<DrawnCells> TwoDrawings() {
  std::vector<DrawnCells> drawn(2);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    drawn[i].side = kSide;
    for (std::size_t cell = 0; cell < kSide * kSide; ++cell) {
      drawn[i].coverage.push_back(static_cast<std::uint8_t>(10 * i + cell));
      for (std::size_t k = 0; k < kCellOrientations; ++k) {
        drawn[i].codes.push_back(static_cast<std::uint8_t>(100 * i + 3 * cell + k));
      }
    }
  }
  return drawn;
}

TEST(PackDrawnCells, ComesBackAsItWas) {
  EXPECT_EQ(UnpackDrawnCells(PackDrawnCells(TwoDrawings()), 2, kSide), TwoDrawings());
}

TEST(UnpackDrawnCells, IsEmptyForOtherBytes) {
  const std::vector<std::byte> packed = PackDrawnCells(TwoDrawings());
  EXPECT_THAT(UnpackDrawnCells(packed, 1, kSide), IsEmpty());
  EXPECT_THAT(UnpackDrawnCells(packed, 3, kSide), IsEmpty());
  EXPECT_THAT(UnpackDrawnCells(packed, 2, kSide + 1), IsEmpty());
  for (std::size_t size = 0; size < packed.size(); ++size) {
    ASSERT_THAT(UnpackDrawnCells(std::span(packed).first(size), 2, kSide), IsEmpty()) << size;
  }
}

TEST(ShapeBankKey, IsHalfAsLargeAnOctaveFurther) {
  const ShapeBankKey coarse{.eighth_octaves = 4};
  const ShapeBankKey glance{.eighth_octaves = 12};
  EXPECT_NEAR(glance.size_px(), coarse.size_px() / 2, 1e-9);
  EXPECT_GE(glance.window() * kCellSide_px, glance.size_px());
}

}  // namespace
}  // namespace victorious
