#include "victorious/search/grammar/neighbour_voting.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace victorious {

namespace {

// The k nearest keypoints of a keypoint, without itself; ties go to the lower index. Cached.
class Neighbourhoods {
 public:
  Neighbourhoods(std::span<const Keypoint> keypoints, int nearest)
      : keypoints_(keypoints), nearest_(static_cast<std::size_t>(nearest)) {}

  const std::vector<std::uint32_t>& NeighboursOf(std::uint32_t centre) {
    const auto [entry, is_new] = cache_.try_emplace(centre);
    if (is_new) entry->second = Find(centre);
    return entry->second;
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> Find(std::uint32_t centre) const {
    std::vector<std::pair<float, std::uint32_t>> others;
    others.reserve(keypoints_.size());
    for (std::uint32_t i = 0; i < keypoints_.size(); ++i) {
      if (i == centre) continue;
      const float dx = keypoints_[i].x - keypoints_[centre].x;
      const float dy = keypoints_[i].y - keypoints_[centre].y;
      others.emplace_back(dx * dx + dy * dy, i);
    }
    const auto count = static_cast<std::ptrdiff_t>(std::min(nearest_, others.size()));
    std::partial_sort(others.begin(), others.begin() + count, others.end());
    std::vector<std::uint32_t> found;
    for (std::ptrdiff_t i = 0; i < count; ++i) found.push_back(others[static_cast<std::size_t>(i)].second);
    std::ranges::sort(found);
    return found;
  }

  std::span<const Keypoint> keypoints_;
  std::size_t nearest_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> cache_;
};

}  // namespace

MatchSet FilterByNeighbours(std::span<const Keypoint> scene, std::span<const Keypoint> model, const MatchSet& matches,
                            const NeighbourVotingOptions& options) {
  // Template keypoints by scene keypoint, to look up the matches of a neighbourhood.
  std::multimap<std::uint32_t, std::uint32_t> model_of;
  for (const Match& match : matches) model_of.emplace(match.scene_keypoint, match.template_keypoint);
  Neighbourhoods in_scene(scene, options.nearest);
  Neighbourhoods in_template(model, options.nearest);
  MatchSet kept;
  for (const Match& match : matches) {
    const std::vector<std::uint32_t>& model_neighbours = in_template.NeighboursOf(match.template_keypoint);
    int votes = 0;
    for (const std::uint32_t neighbour : in_scene.NeighboursOf(match.scene_keypoint)) {
      const auto [first, last] = model_of.equal_range(neighbour);
      for (auto other = first; other != last; ++other)
        votes += std::ranges::binary_search(model_neighbours, other->second) ? 1 : 0;
    }
    if (votes >= options.min_votes) kept.push_back(match);
  }
  return kept;
}

}  // namespace victorious
