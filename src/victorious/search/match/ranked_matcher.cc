#include "victorious/search/match/ranked_matcher.h"

#include <cstddef>
#include <cstdint>

namespace victorious {
namespace {

// @param found  `nearest` a template keypoint
std::vector<RankedMatch> MakeMatches(std::span<const kernels::Neighbour> found, std::size_t nearest) {
  std::vector<RankedMatch> matches;
  matches.reserve(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    matches.push_back(
        {found[i].index, static_cast<std::uint32_t>(i / nearest), static_cast<std::uint32_t>(i % nearest + 1)});
  }
  return matches;
}

}  // namespace

std::vector<RankedMatch> RankedMatcher::Match(const kernels::PackedQueries& model, int nearest) const {
  const auto few = static_cast<std::size_t>(nearest);
  if (scene_.count <= few) return {};
  std::vector<kernels::Neighbour> found(model.count * few);
  kernels::FindNearestK(model, scene_, few, found);
  return MakeMatches(found, few);
}

std::vector<std::vector<RankedMatch>> RankedMatcher::MatchAll(std::span<const kernels::PackedQueries> templates,
                                                              int nearest) const {
  const auto few = static_cast<std::size_t>(nearest);
  std::vector<std::vector<RankedMatch>> matches;
  matches.reserve(templates.size());
  if (device_ != nullptr && scene_.count > few) {
    if (const auto found = FindOnDevice(templates, few)) {
      std::size_t first = 0;
      for (const kernels::PackedQueries& one : templates) {
        matches.push_back(MakeMatches(std::span(*found).subspan(first, one.count * few), few));
        first += one.count * few;
      }
      return matches;
    }
  }
  for (const kernels::PackedQueries& one : templates) matches.push_back(Match(one, nearest));
  return matches;
}

std::optional<std::vector<kernels::Neighbour>> RankedMatcher::FindOnDevice(
    std::span<const kernels::PackedQueries> templates, std::size_t nearest) const {
  std::call_once(uploaded_, [&] { scene_on_device_ = device_->Upload(scene_); });
  if (!scene_on_device_) return std::nullopt;
  const auto queries = device_->Upload(templates);
  if (!queries) return std::nullopt;
  std::size_t count = 0;
  for (const kernels::PackedQueries& one : templates) count += one.count;
  std::vector<kernels::Neighbour> found(count * nearest);
  if (!device_->FindNearestK(*queries, *scene_on_device_, nearest, found)) return std::nullopt;
  return found;
}

}  // namespace victorious
