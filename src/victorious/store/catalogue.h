// The videos and models of an index, looked up by id. Used by the exports and by commands that print names.
#pragma once

#include <cstdint>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The videos and models of a store that match a filter. A filter name that is not in the index is an error (kNotFound)
/// that lists the names that are.
class Catalogue {
 public:
  /// Reads all rows and applies the filter's video, model and category names.
  [[nodiscard]] static Expected<Catalogue> Read(IndexStore& store, const SightingFilter& filter);

  [[nodiscard]] const std::vector<VideoRecord>& videos() const { return videos_; }
  [[nodiscard]] const std::vector<ModelRecord>& models() const { return models_; }
  /// Returns nullptr if `id` is not in the catalogue: it does not match the filter, or another process added it after
  /// Read. O(log n).
  [[nodiscard]] const VideoRecord* Video(std::int64_t id) const;
  [[nodiscard]] const ModelRecord* Model(std::int64_t id) const;

 private:
  std::vector<VideoRecord> videos_;
  std::vector<ModelRecord> models_;
};

}  // namespace victorious
