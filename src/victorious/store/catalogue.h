// The names of what an index holds, looked up by id.
#pragma once

#include <cstdint>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The videos and models of a store that a filter lets through, checked to be there: a name that is not in the index
/// is an error (kNotFound) that tells those that are.
class Catalogue {
 public:
  static Expected<Catalogue> Read(IndexStore& store, const SightingFilter& filter);

  [[nodiscard]] const std::vector<VideoRecord>& videos() const { return videos_; }
  [[nodiscard]] const std::vector<ModelRecord>& models() const { return models_; }
  /// `id` must be of a row that the same filter let through; one added meanwhile by another process has no name yet.
  [[nodiscard]] const VideoRecord* Video(std::int64_t id) const;
  [[nodiscard]] const ModelRecord* Model(std::int64_t id) const;

 private:
  std::vector<VideoRecord> videos_;
  std::vector<ModelRecord> models_;
};

}  // namespace victorious
