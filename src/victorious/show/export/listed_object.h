// An object with its rank and names, as listed by `search` and exported as `objects`.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/show/export/object_moments.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"
#include "victorious/types/json_values.h"

namespace victorious {

struct ListedObject {
  ObjectRecord object;
  std::size_t rank = 0;  ///< from 1
  std::string model;     ///< name of the model or category
  bool is_category = false;
  std::vector<std::string> videos;  ///< names
  std::vector<ObjectMoment> moments;
};

/// Returns the objects that match the filter and whose model is in the catalogue, best first.
[[nodiscard]] Expected<std::vector<ListedObject>> ListObjects(IndexStore& store, const Catalogue& catalogue,
                                                              const SightingFilter& filter);

/// One row of the format `objects` (docs/formats/export.md).
Json ObjectJson(const ListedObject& listed);

/// Speed in three dimensions, m/s; std::nullopt if the motion is unknown.
std::optional<double> ComputeSpeed(const ObjectRecord& object);

}  // namespace victorious
