// Non-maximum suppression, class by class, greedy: the most likely box of a class suppresses those that overlap it.
#pragma once

#include <vector>

#include "victorious/category/network/network_tensor.h"

namespace victorious {

/// A box, and whether the border of its tile may have cut its object.
struct TiledBox {
  NetworkBox found;
  bool is_cut = false;
};

/// @param max_overlap  intersection over union of two boxes that stay
/// @return by falling score; those of equal score in their order
[[nodiscard]] std::vector<NetworkBox> SuppressOverlaps(std::vector<NetworkBox> boxes, double max_overlap);

/// The same for boxes of overlapping tiles: boxes that are cut stand back behind whole ones, and are suppressed by one
/// of their class that contains more than half of them.
[[nodiscard]] std::vector<NetworkBox> MergeTiles(std::vector<TiledBox> boxes, double max_overlap);

}  // namespace victorious
