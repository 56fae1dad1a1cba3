// A cache of what is costly to make: the first that asks for a key makes its value, others that ask for the same key
// wait for it, and nobody waits for another key. The least recently used values go first. Thread-safe.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

template <typename Value>
class OnceCache {
 public:
  using Result = Expected<std::shared_ptr<const Value>>;

  /// @param max_values  that are kept, at least 1; those that are being made count
  explicit OnceCache(std::size_t max_values) : max_values_(max_values) {}

  /// Returns the value of a key. An error goes to all that wait for it, and is not kept.
  /// @param make  returns Expected<Value>; called without a lock
  /// Errors: those of `make`; kInternal for its exceptions.
  template <typename Make>
  [[nodiscard]] Result Get(const std::string& key, const Make& make) {
    const auto [slot, is_new] = FindOrAdd(key);
    if (!is_new) {
      std::unique_lock lock(slot->mutex);
      slot->made.wait(lock, [&] { return slot->result.has_value(); });
      return *slot->result;
    }
    Result result = Call(make);
    if (!result) Forget(key, slot);
    {
      const std::scoped_lock lock(slot->mutex);
      slot->result = result;
    }
    slot->made.notify_all();
    return result;
  }

 private:
  struct Slot {
    std::mutex mutex;
    std::condition_variable made;
    std::optional<Result> result;
  };
  using Entry = std::pair<std::string, std::shared_ptr<Slot>>;

  template <typename Make>
  static Result Call(const Make& make) {
    try {
      Expected<Value> made = make();
      if (!made) return std::unexpected(std::move(made).error());
      return std::make_shared<const Value>(*std::move(made));
    } catch (const std::exception& error) {  // those that wait must be released, too
      return Fail(ErrorCode::kInternal, error.what());
    }
  }

  std::pair<std::shared_ptr<Slot>, bool> FindOrAdd(const std::string& key) {
    const std::scoped_lock lock(mutex_);
    if (const auto found = by_key_.find(key); found != by_key_.end()) {
      entries_.splice(entries_.begin(), entries_, found->second);
      return {found->second->second, false};
    }
    entries_.emplace_front(key, std::make_shared<Slot>());
    by_key_[key] = entries_.begin();
    if (entries_.size() > max_values_) {
      by_key_.erase(entries_.back().first);
      entries_.pop_back();
    }
    return {entries_.front().second, true};
  }

  void Forget(const std::string& key, const std::shared_ptr<Slot>& slot) {
    const std::scoped_lock lock(mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end() || found->second->second != slot) return;
    entries_.erase(found->second);
    by_key_.erase(found);
  }

  std::size_t max_values_;
  std::mutex mutex_;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<std::string, typename std::list<Entry>::iterator> by_key_;
};

/// Get for a value that is made until its maker is cancelled: whoever waited and is not cancelled makes it then.
template <typename Value, typename Make>
[[nodiscard]] typename OnceCache<Value>::Result GetUnlessCancelled(OnceCache<Value>& cache, const std::string& key,
                                                                   const CancelToken& cancel, const Make& make) {
  constexpr int kMaxMakers = 20;
  for (int makers = 1;; ++makers) {
    auto result = cache.Get(key, make);
    const bool is_cancelled = !result && result.error().code == ErrorCode::kCancelled;
    if (!is_cancelled || cancel.IsCancelled() || makers == kMaxMakers) return result;
  }
}

}  // namespace victorious
