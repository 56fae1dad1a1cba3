// What a network returns: arrays of numbers, in the order of its outputs.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "victorious/geometry/box.h"

namespace victorious {

/// An array of numbers, the last dimension fastest.
struct NetworkTensor {
  std::vector<int> shape;
  std::vector<float> values;  ///< as many as the product of `shape`
};

/// "1x3549x85"
[[nodiscard]] std::string ShapeText(std::span<const int> shape);

/// An object that a network finds.
struct NetworkBox {
  Box box;                   ///< px
  std::size_t category = 0;  ///< index of its class
  double score = 0;          ///< 0 to 1, the network's own: not calibrated
};

}  // namespace victorious
