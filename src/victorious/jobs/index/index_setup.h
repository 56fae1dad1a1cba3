// What videos are searched for, and how: shared by all runs of an Indexer.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/object/features/feature_extractor.h"
#include "victorious/types/index_records.h"
#include "victorious/types/object_model.h"

namespace victorious {

struct IndexSetup {
  std::shared_ptr<const std::vector<ObjectModel>> models;  ///< shared with the recognisers of all of them
  IndexOptions options;
  std::unique_ptr<const FeatureExtractor> extractor;
  std::unique_ptr<const FeatureExtractor> kept_extractor;  ///< of the features kept for search by example image
  std::shared_ptr<const CategorySource> categories;        ///< null: none
  /// What is searched for as the store has it, but for the ids: the models in their order, then the categories.
  std::vector<ModelRecord> targets;

  /// True if nothing is searched for: what another program found is entered.
  [[nodiscard]] bool EntersList() const { return categories != nullptr && categories->IsListed(); }
  [[nodiscard]] bool IsModel(std::size_t target) const { return target < models->size(); }
};

/// The record of the same name and content; null: there is none. Of another content, results are not those sought.
[[nodiscard]] const ModelRecord* FindSame(const std::vector<ModelRecord>& records, const ModelRecord& sought);

/// The index identifies models and categories by name, so one would overwrite the other.
/// Error: kInvalidArgument if one of `sought` has the name of another kind of target among `others`.
[[nodiscard]] Status CheckNames(const std::vector<ModelRecord>& sought, const std::vector<ModelRecord>& others);

}  // namespace victorious
