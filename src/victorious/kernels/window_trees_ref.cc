// The reference implementation of the scores of windows: one window at a time.
#include <algorithm>

#include "victorious/kernels/window_trees.h"

namespace victorious::kernels {

void ScoreWindowsRef(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                     std::span<const std::int16_t> floors, std::int16_t* scores) {
  for (std::size_t x = 0; x < count; ++x) {
    const auto is_below = [&](const WindowTree& tree, std::size_t node) {
      return cells[static_cast<std::ptrdiff_t>(x) + tree.offset[node]] < tree.threshold[node];
    };
    int sum = 0;
    bool is_rejected = false;
    for (std::size_t t = 0; t < trees.size() && !is_rejected; ++t) {
      const WindowTree& tree = trees[t];
      const std::size_t side = is_below(tree, 0) ? 0 : 1;
      sum += tree.leaf[2 * side + (is_below(tree, 1 + side) ? 0 : 1)];
      const bool ends_stage = (t + 1) % kTreesPerStage == 0 || t + 1 == trees.size();
      is_rejected = ends_stage && sum < floors[t / kTreesPerStage];
    }
    scores[x] = is_rejected ? kRejectedWindow : static_cast<std::int16_t>(sum);
  }
}

}  // namespace victorious::kernels
