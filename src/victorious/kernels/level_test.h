// A level of its own memory, for the tests of kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "victorious/kernels/level.h"

namespace victorious::kernels {

struct Level {
  std::vector<std::int16_t> pixels;
  LevelView view;

  Level(int width, int height) {
    const std::size_t stride = PaddedWidth(static_cast<std::size_t>(width));
    pixels.resize(stride * static_cast<std::size_t>(height + 1) + kRowMultiple);
    view = {pixels.data(), static_cast<std::ptrdiff_t>(stride), width, height};
  }
  std::int16_t& At(int x, int y) { return pixels[static_cast<std::size_t>(y * view.stride + x)]; }
};

}  // namespace victorious::kernels
