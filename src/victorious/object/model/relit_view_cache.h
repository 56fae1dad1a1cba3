// The memory of relit views (relit_views.h): one budget for the relit templates, surface samples and decoded renderings
// of all models of a search. What is evicted is made again on demand. Renderings at full resolution are evicted first:
// one is ten times as large as a template, and decoded in a tenth of the time that a template takes.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace victorious {

/// Thread-safe.
class RelitViewCache {
 public:
  enum class Kind : std::uint8_t { kRendering, kHalfRendering, kTemplate, kHalfTemplate, kAppearance };

  struct Key {
    std::uint32_t model;  ///< of AddModel()
    Kind kind;
    std::size_t view;
    std::size_t light;  ///< what else the item depends on: sun view, or half octaves

    auto operator<=>(const Key&) const = default;
  };

  static constexpr std::size_t kDefaultMaxBytes = 120'000'000;
  /// The budget where templates are on disk, too (relit_template_folder.h): an evicted one is read again instead of
  /// made. ADR 0010 has the memory and the time of this budget and of larger ones.
  [[nodiscard]] static constexpr std::size_t MaxBytesWithFolder(std::size_t models) {
    constexpr std::size_t kOfModel = 800'000;
    return std::clamp<std::size_t>(models * kOfModel, 16'000'000, 64'000'000);
  }
  /// Renderings that take more than this fraction of the budget are evicted before templates.
  static constexpr double kRenderingsFraction = 0.25;

  /// @param max_bytes  of the sizes that SetSize() tells
  explicit RelitViewCache(std::size_t max_bytes = kDefaultMaxBytes) : max_bytes_(max_bytes) {}

  /// A number for the keys of one model.
  [[nodiscard]] std::uint32_t AddModel();

  /// The item of a key, default-constructed if there is none. Each Kind has one type of item.
  template <typename Item>
  [[nodiscard]] std::shared_ptr<Item> FindOrAdd(const Key& key) {
    const std::scoped_lock lock(mutex_);
    Entry& entry = entries_[key];
    if (!entry.item) entry.item = std::make_shared<Item>();
    entry.last_use = ++uses_;
    return std::static_pointer_cast<Item>(entry.item);
  }

  /// Tells the size of an item. If all are too large together, evicts the least recently used renderings, as long as
  /// they exceed their fraction, and then the least recently used items. An item whose size is unknown stays; users of
  /// an evicted item keep it.
  void SetSize(const Key& key, std::size_t bytes);

  /// Bytes of all items.
  [[nodiscard]] std::size_t size_bytes() const;

 private:
  struct Entry {
    std::shared_ptr<void> item;
    std::size_t bytes = 0;
    std::uint64_t last_use = 0;
  };

  [[nodiscard]] std::vector<Key> OldestFirst() const;
  void Erase(const Key& key);

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  std::map<Key, Entry> entries_;
  std::size_t size_bytes_ = 0;        // of all items
  std::size_t renderings_bytes_ = 0;  // of kind kRendering
  std::uint64_t uses_ = 0;
  std::uint32_t models_ = 0;
};

}  // namespace victorious
