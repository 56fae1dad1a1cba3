#include "victorious/show/choose_moments.h"

#include <algorithm>
#include <optional>

namespace victorious {

std::vector<std::size_t> ChooseMoments(std::span<const MomentRank> ranks, std::size_t count) {
  const std::size_t parts = std::min(ranks.size(), count);
  const std::size_t min_distance = ranks.size() / parts / 2;
  std::vector<std::size_t> chosen;
  const auto quality = [&](std::size_t i) {
    const bool is_apart = std::ranges::none_of(
        chosen, [&](std::size_t one) { return std::max(i, one) - std::min(i, one) < min_distance; });
    return std::pair(is_apart, ranks[i]);
  };
  std::vector<bool> is_done(parts);
  for (std::size_t round = 0; round < parts; ++round) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      if (!is_done[i * parts / ranks.size()] && (!best || quality(i) > quality(*best))) best = i;
    }
    is_done[*best * parts / ranks.size()] = true;
    chosen.push_back(*best);
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace victorious
