#include "victorious/object/model/relit_view_cache.h"

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
  if (size_bytes_ <= max_bytes_) return;
  // A quarter of the budget goes at once: the order of use is not kept sorted.
  const std::size_t kept_bytes = max_bytes_ - max_bytes_ / 4;
  const double kept_renderings_bytes = kRenderingsFraction * static_cast<double>(max_bytes_);
  std::vector<Key> others;
  for (const Key& one : OldestFirst()) {
    if (size_bytes_ <= kept_bytes) return;
    if (one.kind == Kind::kRendering && static_cast<double>(renderings_bytes_) > kept_renderings_bytes) {
      Erase(one);
    } else {
      others.push_back(one);
    }
  }
  for (const Key& one : others) {
    if (size_bytes_ <= kept_bytes) return;
    Erase(one);
  }
}

std::size_t RelitViewCache::size_bytes() const {
  const std::scoped_lock lock(mutex_);
  return size_bytes_;
}

// The items of known size, the least recently used first.
std::vector<RelitViewCache::Key> RelitViewCache::OldestFirst() const {
  std::vector<std::pair<std::uint64_t, Key>> by_use;
  for (const auto& [key, entry] : entries_) {
    if (entry.bytes > 0) by_use.emplace_back(entry.last_use, key);
  }
  std::ranges::sort(by_use);
  std::vector<Key> keys;
  keys.reserve(by_use.size());
  for (const auto& [last_use, key] : by_use) keys.push_back(key);
  return keys;
}

void RelitViewCache::Erase(const Key& key) {
  const auto entry = entries_.find(key);
  size_bytes_ -= entry->second.bytes;
  if (key.kind == Kind::kRendering) renderings_bytes_ -= entry->second.bytes;
  entries_.erase(entry);
}

}  // namespace victorious
