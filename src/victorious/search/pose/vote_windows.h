// pose/, the votes that each vote is compared with: shared by VotePoses and ProposePose.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "victorious/kernels/vote_agreement.h"

namespace victorious {

/// For each vote: the range of votes whose scale agrees with its own, and the squared distance of agreeing centres.
/// @param log_scales     rising
/// @param max_log_scale  two votes agree in scale up to this difference
/// @param reach_px       two centres agree up to this distance at scale 1
inline std::vector<kernels::VoteWindow> ComputeVoteWindows(std::span<const float> log_scales, float max_log_scale,
                                                           float reach_px) {
  std::vector<kernels::VoteWindow> windows(log_scales.size());
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < log_scales.size(); ++i) {
    while (log_scales[begin] < log_scales[i] - max_log_scale) ++begin;
    while (end < log_scales.size() && log_scales[end] <= log_scales[i] + max_log_scale) ++end;
    const float reach = reach_px * std::exp(log_scales[i]);
    windows[i] = {begin, end, reach * reach};
  }
  return windows;
}

}  // namespace victorious
