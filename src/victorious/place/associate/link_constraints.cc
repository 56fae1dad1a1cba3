#include "victorious/place/associate/link_constraints.h"

#include <algorithm>
#include <ranges>
#include <vector>

namespace victorious {

LinkConstraints::LinkConstraints(std::span<const TrackletLink> links) {
  for (const TrackletLink& link : links | std::views::reverse) {
    if (link.is_one) {
      AddMustLink(link.first, link.second);
    } else {
      AddCannotLink(link.first, link.second);
    }
  }
}

std::int64_t LinkConstraints::GroupOf(std::int64_t tracklet) const {
  const auto found = group_of_.find(tracklet);
  return found == group_of_.end() ? tracklet : found->second;
}

void LinkConstraints::AddMustLink(std::int64_t first, std::int64_t second) {
  const std::int64_t of_first = GroupOf(first);
  const std::int64_t of_second = GroupOf(second);
  if (of_first == of_second || AreApart(of_first, of_second)) return;
  const std::int64_t joined = std::min(of_first, of_second);
  const std::int64_t former = std::max(of_first, of_second);
  group_of_[of_first] = joined;
  group_of_[of_second] = joined;
  for (auto& [tracklet, group] : group_of_) {
    if (group == former) group = joined;
  }
  std::vector<std::int64_t> others;
  for (const auto& [group, other] : apart_) {
    if (group == former) others.push_back(other);
  }
  for (const std::int64_t other : others) {
    apart_.erase({former, other});
    apart_.erase({other, former});
    Separate(joined, other);
  }
}

void LinkConstraints::AddCannotLink(std::int64_t first, std::int64_t second) {
  if (GroupOf(first) != GroupOf(second)) Separate(GroupOf(first), GroupOf(second));
}

void LinkConstraints::Separate(std::int64_t first_group, std::int64_t second_group) {
  apart_.insert({first_group, second_group});
  apart_.insert({second_group, first_group});
}

bool LinkConstraints::CannotLink(std::span<const ObservedTracklet* const> some,
                                 std::span<const ObservedTracklet* const> others) const {
  if (apart_.empty()) return false;
  return std::ranges::any_of(some, [&](const ObservedTracklet* one) {
    return std::ranges::any_of(others, [&](const ObservedTracklet* other) {
      return AreApart(GroupOf(one->record.id), GroupOf(other->record.id));
    });
  });
}

bool LinkConstraints::CannotLink(std::span<const std::int64_t> some, std::span<const std::int64_t> others) const {
  if (apart_.empty()) return false;
  return std::ranges::any_of(some, [&](std::int64_t one) {
    return std::ranges::any_of(others, [&](std::int64_t other) { return AreApart(GroupOf(one), GroupOf(other)); });
  });
}

}  // namespace victorious
