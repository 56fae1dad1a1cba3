// From an index to what is scored: the objects and sightings of models; categories are left out, as truth names models.
#pragma once

#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/score.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// What an index reports.
struct Reported {
  std::vector<ReportedObject> objects;  ///< best first
  std::vector<ReportedSighting> sightings;
};

/// @param filter  lets one video through, for ScoreIndex()
/// Errors: those of Catalogue::Read and of reading.
Expected<Reported> ReadReported(IndexStore& store, const SightingFilter& filter);

}  // namespace victorious
