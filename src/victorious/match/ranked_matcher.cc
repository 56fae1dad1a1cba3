#include "victorious/match/ranked_matcher.h"

namespace victorious {

std::vector<RankedMatch> RankedMatcher::Match(const kernels::PackedQueries& model, int nearest) const {
  const auto few = static_cast<std::size_t>(nearest);
  if (scene_.count <= few) return {};
  std::vector<kernels::Neighbour> found(model.count * few);
  kernels::FindNearestK(model, scene_, few, found);
  std::vector<RankedMatch> matches;
  matches.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    matches.push_back({found[i].index, static_cast<std::uint32_t>(i / few), static_cast<std::uint32_t>(i % few + 1)});
  }
  return matches;
}

}  // namespace victorious
