// Reads from an index the objects and sightings to score (score.h). Category objects and sightings are left out,
// because the ground truth names models only.
#pragma once

#include <vector>

#include "victorious/base/error.h"
#include "victorious/lab/evaluate/score.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The content of an index that is scored.
struct ReportedContent {
  std::vector<ReportedObject> objects;  ///< best first
  std::vector<ReportedSighting> sightings;
};

/// @param filter  must select a single video for ScoreIndex()
/// Errors: those of Catalogue::Read and of reading the store.
[[nodiscard]] Expected<ReportedContent> ReadReported(IndexStore& store, const SightingFilter& filter);

}  // namespace victorious
