// The reference implementation of WindowProducts: one value at a time.
#include "victorious/kernels/window_products.h"

namespace victorious::kernels {

void WindowProductsRef(const MapView& map, const BankView& bank, std::span<std::int32_t> out) {
  const std::size_t row_values = bank.width * map.depth;
  std::size_t i = 0;
  for (std::size_t t = 0; t < bank.templates; ++t) {
    const std::int16_t* const values = bank.values + t * bank.height * row_values;
    for (std::size_t y = 0; y + bank.height <= map.rows; ++y) {
      for (std::size_t x = 0; x + bank.width <= map.cols; ++x) {
        std::int32_t product = 0;
        for (std::size_t r = 0; r < bank.height; ++r) {
          const std::int16_t* const cells = map.values + ((y + r) * map.cols + x) * map.depth;
          for (std::size_t k = 0; k < row_values; ++k) product += cells[k] * values[r * row_values + k];
        }
        out[i++] = product;
      }
    }
  }
}

}  // namespace victorious::kernels
