#include "victorious/kernels/window_trees.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "victorious/base/random.h"
#include "victorious/kernels/target_test.h"

namespace victorious::kernels {
namespace {

TEST(ScoreWindows, SumsTheLeavesThatTheNodesChoose) {
  const std::vector<std::uint8_t> cells = {10, 20, 30, 40};
  const std::vector<WindowTree> trees = {
      {.offset = {0, 1, 2}, .threshold = {15, 25, 35}, .leaf = {1, 2, 4, 8}},
      {.offset = {1, 0, 0}, .threshold = {25, 15, 25}, .leaf = {16, 32, 64, 127}},
  };
  std::vector<std::int16_t> scores(2);
  const std::vector<std::int16_t> floors = {20};
  ScoreWindowsRef(cells.data(), 2, trees, floors, scores.data());
  EXPECT_EQ(scores, (std::vector<std::int16_t>{kRejectedWindow, 8 + 64}));  // 1 + 16 is below the floor
}

class WindowTreesTarget : public TargetTest {};

TEST_P(WindowTreesTarget, ScoresAsTheReference) {
  Random random(5);
  const auto byte = [&] { return static_cast<std::uint8_t>(random.Below(256)); };
  for (const std::size_t count : {1U, 5U, 16U, 31U, 64U, 100U, 333U}) {
    for (const std::size_t tree_count : {0U, 1U, 8U, 21U, 256U}) {
      const std::size_t reach = 300;
      std::vector<std::uint8_t> cells(count + reach + kWindowPadding);
      for (std::uint8_t& cell : cells) cell = byte();
      std::vector<WindowTree> trees(tree_count);
      for (WindowTree& tree : trees) {
        for (std::int32_t& offset : tree.offset) offset = static_cast<std::int32_t>(random.Below(reach));
        for (std::uint8_t& threshold : tree.threshold) threshold = byte();
        for (std::int8_t& leaf : tree.leaf) leaf = static_cast<std::int8_t>(static_cast<int>(random.Below(255)) - 127);
      }
      if (tree_count == kMaxWindowTrees) {
        for (WindowTree& tree : trees) tree.leaf = {127, 127, 127, 127};  // the largest sum
      }
      std::vector<std::int16_t> floors((tree_count + kTreesPerStage - 1) / kTreesPerStage);
      for (std::int16_t& floor : floors) floor = static_cast<std::int16_t>(static_cast<int>(random.Below(600)) - 500);
      std::vector<std::int16_t> scores(count + kWindowPadding);
      std::vector<std::int16_t> expected(count);
      ScoreWindows(cells.data(), count, trees, floors, scores.data());
      ScoreWindowsRef(cells.data(), count, trees, floors, expected.data());
      scores.resize(count);
      EXPECT_EQ(scores, expected) << count << ' ' << tree_count;
    }
  }
}

VICTORIOUS_EVERY_TARGET(WindowTreesTarget);

}  // namespace
}  // namespace victorious::kernels
