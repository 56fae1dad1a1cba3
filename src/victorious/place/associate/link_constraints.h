// What people say of the identity of tracklets, as constraints of data association: must-link and cannot-link.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "victorious/place/associate/observed_tracklet.h"
#include "victorious/types/tracklet_link.h"

namespace victorious {

class LinkConstraints {
 public:
  LinkConstraints() = default;
  /// @param links  of those that contradict one another the later ones count
  explicit LinkConstraints(std::span<const TrackletLink> links);

  /// A must-link: all that is linked with one of them is one object. Without effect against a cannot-link.
  void AddMustLink(std::int64_t first, std::int64_t second);
  /// A cannot-link, which holds for all that must be one object with one of them. Without effect against a must-link.
  void AddCannotLink(std::int64_t first, std::int64_t second);

  /// Whether there is a must-link.
  [[nodiscard]] bool HasGroups() const { return !group_of_.empty(); }
  /// The smallest id of those that must be one object with a tracklet; its own id if none must.
  [[nodiscard]] std::int64_t GroupOf(std::int64_t tracklet) const;

  /// Whether a cannot-link stands between any of some tracklets and any of others.
  [[nodiscard]] bool CannotLink(std::span<const ObservedTracklet* const> some,
                                std::span<const ObservedTracklet* const> others) const;
  /// The same of ids.
  [[nodiscard]] bool CannotLink(std::span<const std::int64_t> some, std::span<const std::int64_t> others) const;

 private:
  [[nodiscard]] bool AreApart(std::int64_t first_group, std::int64_t second_group) const {
    return apart_.contains({first_group, second_group});
  }
  void Separate(std::int64_t first_group, std::int64_t second_group);

  std::map<std::int64_t, std::int64_t> group_of_;          // without those that are alone
  std::set<std::pair<std::int64_t, std::int64_t>> apart_;  // groups, both ways round
};

}  // namespace victorious
