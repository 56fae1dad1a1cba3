#include "victorious/kernels/window_products.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

using Values = std::vector<std::int16_t>;

struct Sizes {
  std::size_t rows, cols, depth, templates, height, width;

  std::size_t map_values() const { return rows * cols * depth; }
  std::size_t template_values() const { return height * width * depth; }
  std::size_t products() const { return templates * (rows - height + 1) * (cols - width + 1); }
};

constexpr std::int32_t kUntouched = -7;

// The products, and one value beyond them.
std::vector<std::int32_t> Multiply(decltype(&WindowProducts) multiply, const Sizes& sizes, const Values& map,
                                   const Values& bank) {
  std::vector<std::int32_t> out(sizes.products() + 1, kUntouched);
  multiply({map.data(), sizes.rows, sizes.cols, sizes.depth}, {bank.data(), sizes.templates, sizes.height, sizes.width},
           std::span(out).first(sizes.products()));
  return out;
}

TEST(WindowProducts, AreThoseOfTheWindowAtEachPosition) {
  const Sizes sizes = {.rows = 2, .cols = 3, .depth = 2, .templates = 2, .height = 1, .width = 2};
  const Values map = {1, 2, 3, 4,  5,  6,  //
                      7, 8, 9, 10, 11, 12};
  const Values bank = {1,  0, 0, 100,  //
                       -1, 0, 1, 0};
  EXPECT_EQ(Multiply(&WindowProductsRef, sizes, map, bank),
            (std::vector<std::int32_t>{401, 603, 1007, 1209, 2, 2, 2, 2, kUntouched}));
}

class WindowProductsTarget : public TargetTest {};

TEST_P(WindowProductsTarget, AreThoseOfTheReference) {
  Random random(5);
  for (const Sizes& sizes :
       {Sizes{1, 1, 1, 1, 1, 1}, Sizes{3, 5, 1, 2, 2, 3}, Sizes{7, 9, 3, 4, 3, 2}, Sizes{11, 13, 8, 5, 4, 5},
        Sizes{9, 40, 8, 7, 9, 23}, Sizes{12, 10, 5, 13, 5, 7}, Sizes{30, 34, 8, 36, 24, 24}, Sizes{6, 70, 33, 3, 2, 1},
        Sizes{5, 7, 64, 12, 5, 7}, Sizes{4, 6, 8, 0, 2, 2}}) {
    for (const std::uint32_t levels : {2U, 256U}) {  // extreme values only, or all
      Values map(sizes.map_values());
      for (std::int16_t& value : map) {
        value = static_cast<std::int16_t>(random.Below(levels) * kMaxMapValue / (levels - 1));
      }
      Values bank(sizes.templates * sizes.template_values());
      for (std::int16_t& value : bank) {
        const int step = 2 * kMaxTemplateValue / static_cast<int>(levels - 1);
        value = static_cast<std::int16_t>(static_cast<int>(random.Below(levels)) * step - kMaxTemplateValue);
      }
      EXPECT_EQ(Multiply(&WindowProducts, sizes, map, bank), Multiply(&WindowProductsRef, sizes, map, bank))
          << sizes.templates << " templates of " << sizes.height << " x " << sizes.width << " x " << sizes.depth
          << " in " << sizes.rows << " x " << sizes.cols << ", " << levels << " levels";
    }
  }
}

// The largest sums of either sign.
TEST_P(WindowProductsTarget, FitIn32Bits) {
  const Sizes sizes = {.rows = 33, .cols = 34, .depth = 8, .templates = 2, .height = 32, .width = 32};
  ASSERT_EQ(sizes.template_values(), kMaxWindowValues);
  const Values map(sizes.map_values(), kMaxMapValue);
  Values bank(2 * kMaxWindowValues, kMaxTemplateValue);
  std::fill(bank.begin() + kMaxWindowValues, bank.end(), static_cast<std::int16_t>(-kMaxTemplateValue));
  const std::int32_t most = 2'137'006'080;  // 255 x 1023 x 8192
  EXPECT_EQ(Multiply(&WindowProducts, sizes, map, bank),
            (std::vector<std::int32_t>{most, most, most, most, most, most, -most, -most, -most, -most, -most, -most,
                                       kUntouched}));
}

VICTORIOUS_EVERY_TARGET(WindowProductsTarget);

}  // namespace
}  // namespace victorious::kernels
