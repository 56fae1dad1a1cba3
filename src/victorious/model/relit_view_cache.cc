#include "victorious/model/relit_view_cache.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace victorious {

std::uint32_t RelitViewCache::AddModel() {
  const std::scoped_lock lock(mutex_);
  return models_++;
}

void RelitViewCache::SetSize(const Key& key, std::size_t bytes) {
  const std::scoped_lock lock(mutex_);
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return;
  size_bytes_ += bytes - entry->second.bytes;
  entry->second.bytes = bytes;
  if (size_bytes_ > max_bytes_) EvictOldest();
}

std::size_t RelitViewCache::size_bytes() const {
  const std::scoped_lock lock(mutex_);
  return size_bytes_;
}

// Evicts a quarter of the budget at once: the order of use is not kept sorted.
void RelitViewCache::EvictOldest() {
  const std::size_t kept_bytes = max_bytes_ - max_bytes_ / 4;
  std::vector<std::pair<std::uint64_t, Key>> oldest_first;
  for (const auto& [key, entry] : entries_) {
    if (entry.bytes > 0) oldest_first.emplace_back(entry.last_use, key);
  }
  std::ranges::sort(oldest_first);
  for (const auto& [last_use, key] : oldest_first) {
    if (size_bytes_ <= kept_bytes) break;
    const auto entry = entries_.find(key);
    size_bytes_ -= entry->second.bytes;
    entries_.erase(entry);
  }
}

}  // namespace victorious
