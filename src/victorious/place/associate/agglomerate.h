// Private to associate/: agglomerative clustering, the nearest pair first, until no pair can be joined.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace victorious {

/// Clusters items. Deterministic: of pairs at the same distance the one with the smaller ids is joined first.
/// @param singles  one cluster an item
/// @param rules    with these members:
///                 - `std::int64_t Id(const Cluster&)`: unique; of a joined cluster the smaller one of its parts
///                 - `void Add(Cluster&)`, `void Remove(Cluster&)`: called as clusters appear and disappear
///                 - a range of ids `Near(Cluster&)`: of added clusters that may be joined with this one; may contain
///                   its own
///                 - `std::optional<double> Distance(Cluster& first, Cluster& second)`: std::nullopt if they are two;
///                   `first` has the smaller id
///                 - `std::optional<Cluster> Join(Cluster& first, Cluster& second)`: std::nullopt if they are two
/// @return by id
template <typename Cluster, typename Rules>
[[nodiscard]] std::vector<Cluster> Agglomerate(std::vector<Cluster> singles, Rules& rules) {
  struct Node {
    Cluster cluster;
    std::int64_t version = 0;  // of all nodes with this id
  };
  struct Pair {
    double distance;
    std::int64_t first;
    std::int64_t second;
    std::int64_t version_of_first;
    std::int64_t version_of_second;

    bool operator>(const Pair& other) const {
      return std::tie(distance, first, second) > std::tie(other.distance, other.first, other.second);
    }
  };
  std::map<std::int64_t, Node> nodes;
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> pairs;
  std::int64_t versions = 0;

  const auto add = [&](Cluster cluster) {
    const std::int64_t id = rules.Id(cluster);
    Node& added = nodes[id] = {.cluster = std::move(cluster), .version = ++versions};
    rules.Add(added.cluster);
    for (const std::int64_t other_id : rules.Near(added.cluster)) {
      if (other_id == id) continue;
      const std::int64_t first = std::min(id, other_id);
      const std::int64_t second = std::max(id, other_id);
      Node& of_first = nodes.at(first);
      Node& of_second = nodes.at(second);
      if (const std::optional<double> distance = rules.Distance(of_first.cluster, of_second.cluster))
        pairs.push({*distance, first, second, of_first.version, of_second.version});
    }
  };
  const auto is_current = [&](std::int64_t id, std::int64_t version) {
    const auto node = nodes.find(id);
    return node != nodes.end() && node->second.version == version;
  };

  for (Cluster& single : singles) add(std::move(single));
  while (!pairs.empty()) {
    const Pair nearest = pairs.top();
    pairs.pop();
    if (!is_current(nearest.first, nearest.version_of_first)) continue;
    if (!is_current(nearest.second, nearest.version_of_second)) continue;
    Cluster& first = nodes.at(nearest.first).cluster;
    Cluster& second = nodes.at(nearest.second).cluster;
    std::optional<Cluster> joined = rules.Join(first, second);
    if (!joined) continue;
    rules.Remove(first);
    rules.Remove(second);
    nodes.erase(nearest.first);
    nodes.erase(nearest.second);
    add(*std::move(joined));
  }
  std::vector<Cluster> result;
  for (auto& [id, node] : nodes) result.push_back(std::move(node.cluster));
  return result;
}

}  // namespace victorious
