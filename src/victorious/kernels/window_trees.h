// kernels/, the loop of window detectors (category/channels/): scores of all windows of a row by boosted trees of two
// levels on bytes, with a cascade. With f(x) = cells[offset + x], a tree is
//   f0 < t0 ? (f1 < t1 ? leaf0 : leaf1) : (f2 < t2 ? leaf2 : leaf3),
// and a window's score is the sum of its trees. After every kTreesPerStage trees a window whose sum is below the floor
// of this stage is rejected (P. Dollár et al., "Fast feature pyramids for object detection", PAMI 2014).
// Reference: window_trees_ref.cc; window_trees_simd.cc (Highway, every instruction set) gives the same numbers.
// C++20: no <expected> here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace victorious::kernels {

inline constexpr std::size_t kTreesPerStage = 8;
inline constexpr std::size_t kMaxWindowTrees = 256;  ///< the sum of so many leaves is a 16-bit number
inline constexpr std::size_t kWindowPadding = 64;    ///< windows beyond a row that are computed too
inline constexpr std::int16_t kRejectedWindow = -32768;

struct WindowTree {
  std::array<std::int32_t, 3> offset{};  ///< of the three nodes, from the window's first byte
  std::array<std::uint8_t, 3> threshold{};
  std::array<std::int8_t, 4> leaf{};
};

/// @param cells   of the first window; kWindowPadding bytes after each offset of the last window can be read
/// @param trees   at most kMaxWindowTrees
/// @param floors  one a stage: as many as trees.size() / kTreesPerStage, rounded up
/// @param scores  of `count` windows, or kRejectedWindow; kWindowPadding more elements may be overwritten
void ScoreWindows(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                  std::span<const std::int16_t> floors, std::int16_t* scores);
void ScoreWindowsRef(const std::uint8_t* cells, std::size_t count, std::span<const WindowTree> trees,
                     std::span<const std::int16_t> floors, std::int16_t* scores);

}  // namespace victorious::kernels
