// pose/, the loops over votes: which votes agree with each other, and which pairs of keypoints agree with a map.
// Source: the windows of search/pose/vote_poses.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace victorious::kernels {

/// Arrays of votes and pairs are readable to this many floats beyond their last one, which count for nothing.
inline constexpr std::size_t kVotePadding = 16;

/// Votes for a position and a rotation, as padded arrays. Non-owning.
struct VoteArrays {
  const float* x;         ///< px
  const float* y;         ///< px
  const float* turn_rad;  ///< [-pi, pi]
};

/// The votes that one vote is compared with, and the square of the distance within which they agree.
struct VoteWindow {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  float reach2_px2 = 0;
};

/// For each vote i: the number of votes j of its window, i included, with
///   (x_j - x_i)^2 + (y_j - y_i)^2 < reach2_px2  and  the smaller angle between turn_j and turn_i < turn_rad.
/// @param windows  one a vote
/// @param counts   one a vote
void CountAgreeingVotes(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                        std::span<std::int32_t> counts);
void CountAgreeingVotesRef(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                           std::span<std::int32_t> counts);

/// Pairs of a point in the template and one in the scene, as padded arrays. Non-owning.
struct PairArrays {
  const float* template_x;  ///< px
  const float* template_y;
  const float* scene_x;  ///< px
  const float* scene_y;
};

/// (x, y) -> (a x - b y + shift_x, b x + a y + shift_y): a similarity from template to scene.
struct SimilarityMap {
  float a = 0;
  float b = 0;
  float shift_x = 0;
  float shift_y = 0;
};

/// The pairs in [begin, end) whose template point is mapped to a square distance of at most reach2_px2 from the scene
/// point.
/// @param pair        ascending indices; room for end - begin and kVotePadding more
/// @param error2_px2  their square distances; likewise
/// @return their number
std::size_t FindAgreeingPairs(const PairArrays& pairs, std::size_t begin, std::size_t end, const SimilarityMap& map,
                              float reach2_px2, std::uint32_t* pair, float* error2_px2);
std::size_t FindAgreeingPairsRef(const PairArrays& pairs, std::size_t begin, std::size_t end, const SimilarityMap& map,
                                 float reach2_px2, std::uint32_t* pair, float* error2_px2);

}  // namespace victorious::kernels
