// The definition of dog_extrema.h.
#include "victorious/kernels/dog_extrema.h"

namespace victorious::kernels {

std::size_t FindDogExtremaRef(const LevelRows& rows, std::int32_t first_x, std::int32_t end_x, std::int16_t threshold,
                              DogExtremum* out) {
  const auto difference = [&](std::size_t layer, std::size_t row, std::int32_t x) {
    return rows.row[layer + 1][row][x] - rows.row[layer][row][x];
  };
  std::size_t count = 0;
  for (std::int32_t x = first_x; x < end_x; ++x) {
    for (std::size_t layer = 1; layer <= kSearchedLayers; ++layer) {
      const int centre = difference(layer, 1, x);
      bool highest = centre > threshold;
      bool lowest = centre < -threshold;
      for (std::size_t near_layer = layer - 1; near_layer <= layer + 1; ++near_layer) {
        for (std::size_t row = 0; row < 3; ++row) {
          for (std::int32_t near_x = x - 1; near_x <= x + 1; ++near_x) {
            const int other = difference(near_layer, row, near_x);
            highest = highest && centre >= other;
            lowest = lowest && centre <= other;
          }
        }
      }
      if (highest || lowest) out[count++] = {x, static_cast<std::int32_t>(layer)};
    }
  }
  return count;
}

}  // namespace victorious::kernels
