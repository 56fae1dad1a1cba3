// For tests of index stores: batches as the indexer commits them.
#pragma once

#include <cstdint>
#include <optional>

#include "victorious/store/index_store.h"

namespace victorious::testing {

inline constexpr int kSightingsInBatch = 20;

/// A new object with sightings in the frames [first, first + kSightingsInBatch), and the corresponding progress.
inline IndexBatch SightingBatch(std::int64_t video, std::int64_t model, std::int64_t first) {
  IndexBatch batch;
  batch.tracklets.push_back(
      {std::nullopt, {.video = video, .model = model, .score = 0.5, .frames = kSightingsInBatch}});
  for (int i = 0; i < kSightingsInBatch; ++i) {
    batch.sightings.push_back({0, {.frame = first + i, .outline = {{0, 0}, {9, 0}, {9, 9}}, .score = 0.5}});
  }
  batch.progress.push_back(
      {{.video = video, .model = model, .next_frame = first + kSightingsInBatch, .options_json = "{}"}, first});
  return batch;
}

}  // namespace victorious::testing
