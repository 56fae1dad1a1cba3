// The definition of vote_agreement.h.
#include <algorithm>
#include <cmath>

#include "victorious/kernels/vote_agreement.h"

namespace victorious::kernels {
namespace {

constexpr float kCircle_rad = 6.28318530717958647692F;

}  // namespace

void CountAgreeingVotesRef(const VoteArrays& votes, std::span<const VoteWindow> windows, float turn_rad,
                           std::span<std::int32_t> counts) {
  for (std::size_t i = 0; i < windows.size(); ++i) {
    counts[i] = 0;
    for (std::size_t j = windows[i].begin; j < windows[i].end; ++j) {
      const float dx = votes.x[j] - votes.x[i];
      const float dy = votes.y[j] - votes.y[i];
      const float difference = std::abs(votes.turn_rad[j] - votes.turn_rad[i]);
      const float turn = std::min(difference, std::abs(kCircle_rad - difference));
      if (dx * dx + dy * dy < windows[i].reach2_px2 && turn < turn_rad) ++counts[i];
    }
  }
}

std::size_t FindAgreeingPairsRef(const PairArrays& pairs, std::size_t begin, std::size_t end, const SimilarityMap& map,
                                 float reach2_px2, std::uint32_t* pair, float* error2_px2) {
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const float dx = map.a * pairs.template_x[i] - map.b * pairs.template_y[i] + map.shift_x - pairs.scene_x[i];
    const float dy = map.b * pairs.template_x[i] + map.a * pairs.template_y[i] + map.shift_y - pairs.scene_y[i];
    const float error2 = dx * dx + dy * dy;
    if (!(error2 <= reach2_px2)) continue;
    pair[count] = static_cast<std::uint32_t>(i);
    error2_px2[count++] = error2;
  }
  return count;
}

}  // namespace victorious::kernels
