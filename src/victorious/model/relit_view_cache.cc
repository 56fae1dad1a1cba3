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
  if (key.kind == Kind::kRendering) renderings_bytes_ += bytes - entry->second.bytes;
  entry->second.bytes = bytes;
  const auto max_renderings_bytes = static_cast<std::size_t>(kMaxRenderingsFraction * static_cast<double>(max_bytes_));
  EvictOldest(max_renderings_bytes, renderings_bytes_, [](const Key& one) { return one.kind == Kind::kRendering; });
  EvictOldest(max_bytes_, size_bytes_, [](const Key&) { return true; });
}

std::size_t RelitViewCache::size_bytes() const {
  const std::scoped_lock lock(mutex_);
  return size_bytes_;
}

// Evicts a quarter of max_bytes at once, if `bytes` of the included items exceed it: the order of use is not kept sorted.
template <typename Predicate>
void RelitViewCache::EvictOldest(std::size_t max_bytes, std::size_t& bytes, const Predicate& includes) {
  if (bytes <= max_bytes) return;
  const std::size_t kept_bytes = max_bytes - max_bytes / 4;
  std::vector<std::pair<std::uint64_t, Key>> oldest_first;
  for (const auto& [key, entry] : entries_) {
    if (entry.bytes > 0 && includes(key)) oldest_first.emplace_back(entry.last_use, key);
  }
  std::ranges::sort(oldest_first);
  for (const auto& [last_use, key] : oldest_first) {
    if (bytes <= kept_bytes) break;
    Erase(key);
  }
}

void RelitViewCache::Erase(const Key& key) {
  const auto entry = entries_.find(key);
  size_bytes_ -= entry->second.bytes;
  if (key.kind == Kind::kRendering) renderings_bytes_ -= entry->second.bytes;
  entries_.erase(entry);
}

}  // namespace victorious
