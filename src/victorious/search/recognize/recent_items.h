// Private to recognize/: what is made on demand, within a budget of memory. What is evicted is made again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace victorious {

/// Thread-safe.
template <typename Key, typename Item>
class RecentItems {
 public:
  /// @param max_bytes  of the sizes that Put() tells
  explicit RecentItems(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Null if it is not there (any more).
  [[nodiscard]] std::shared_ptr<const Item> Find(const Key& key) {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    found->second.last_use = ++uses_;
    return found->second.item;
  }

  /// Returns the item of the key: the first one that was put. If all are too large together, those that were not used
  /// for the longest time are evicted, a quarter of the budget at once; users of an evicted item keep it.
  std::shared_ptr<const Item> Put(const Key& key, Item item, std::size_t bytes) {
    const std::scoped_lock lock(mutex_);
    const auto [entry, is_new] = entries_.try_emplace(key);
    entry->second.last_use = ++uses_;
    if (!is_new) return entry->second.item;
    std::shared_ptr<const Item> made = std::make_shared<const Item>(std::move(item));
    entry->second.item = made;
    entry->second.bytes = bytes;
    size_bytes_ += bytes;
    if (size_bytes_ > max_bytes_) Evict();
    return made;
  }

  /// Of all items.
  [[nodiscard]] std::size_t size_bytes() const {
    const std::scoped_lock lock(mutex_);
    return size_bytes_;
  }

 private:
  struct Entry {
    std::shared_ptr<const Item> item;
    std::size_t bytes = 0;
    std::uint64_t last_use = 0;
  };

  void Evict() {
    std::vector<std::pair<std::uint64_t, Key>> by_use;
    for (const auto& [key, entry] : entries_) by_use.emplace_back(entry.last_use, key);
    std::ranges::sort(by_use);
    for (const auto& [last_use, key] : by_use) {
      if (size_bytes_ <= max_bytes_ - max_bytes_ / 4) return;
      const auto entry = entries_.find(key);
      size_bytes_ -= entry->second.bytes;
      entries_.erase(entry);
    }
  }

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  std::map<Key, Entry> entries_;
  std::size_t size_bytes_ = 0;
  std::uint64_t uses_ = 0;
};

}  // namespace victorious
