// The parameters of a search as the index keeps them, and how those of a search that began before differ from those of
// now.
#pragma once

#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/jobs/index/index_job.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// The parameters of a search as JSON.
struct StoredParameters {
  std::string models;      ///< of a search for models
  std::string categories;  ///< of a search for categories
  std::string features;    ///< of the features that are kept

  [[nodiscard]] const std::string& Of(const ModelRecord& target) const {
    return target.IsCategory() ? categories : models;
  }
};

[[nodiscard]] StoredParameters ParametersOf(const IndexOptions& options, const SearchIntervals& intervals,
                                            const IndexJob& job);

/// The parameters of one search as JSON.
/// @param every    the interval that was chosen
/// @param tracked  that of SearchIntervals
/// @param job      its interval of time and its budget belong to what was searched
[[nodiscard]] std::string SearchOptionsText(IndexOptions options, int every, int tracked, const IndexJob& job);

/// How the parameters of the first search that differs, of those that are sought, differ from those of now, for a
/// person; empty: none does. What the program did not have when the search began is what it is by default.
/// @param defaults  what they are if nothing is set
/// Errors: those of the store.
[[nodiscard]] Expected<std::string> FindDifference(const VideoRecord& video, const std::vector<ModelRecord>& sought,
                                                   const StoredParameters& now, const StoredParameters& defaults,
                                                   IndexStore& store);

}  // namespace victorious
