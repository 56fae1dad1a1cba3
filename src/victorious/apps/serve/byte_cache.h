// A cache of byte strings (images, large JSON bodies) by key, bounded in size; the least recently used go first.
// Thread-safe.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

namespace victorious {

class ByteCache {
 public:
  explicit ByteCache(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Returns the value of a key; null if it is not cached.
  [[nodiscard]] std::shared_ptr<const std::string> Find(const std::string& key) {
    const std::scoped_lock lock(mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->second;
  }

  void Put(const std::string& key, std::shared_ptr<const std::string> value) {
    const std::scoped_lock lock(mutex_);
    if (value->size() > max_bytes_ || by_key_.contains(key)) return;
    bytes_ += value->size();
    entries_.emplace_front(key, std::move(value));
    by_key_[key] = entries_.begin();
    while (bytes_ > max_bytes_) {
      bytes_ -= entries_.back().second->size();
      by_key_.erase(entries_.back().first);
      entries_.pop_back();
    }
  }

 private:
  using Entry = std::pair<std::string, std::shared_ptr<const std::string>>;

  std::size_t max_bytes_;
  std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_key_;
};

}  // namespace victorious
