// An object as it is listed: with its rank and its names, and its values as people and other programs read them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/export_json.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct ListedObject {
  ObjectRecord object;
  std::size_t rank = 0;  ///< from 1
  std::string model;     ///< the name, of a category too
  bool is_category = false;
  std::vector<std::string> videos;
};

/// Best first, what the filter lets through and the catalogue knows.
Expected<std::vector<ListedObject>> ListObjects(IndexStore& store, const Catalogue& catalogue,
                                                const SightingFilter& filter);

/// The keys of the format `objects` (docs/formats/export.md).
Json ObjectJson(const ListedObject& listed);

/// m/s along the ground and upwards together; nothing where motion is not known.
std::optional<double> SpeedOf(const ObjectRecord& object);

}  // namespace victorious
