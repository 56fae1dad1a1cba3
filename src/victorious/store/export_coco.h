// COCO detection JSON.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// One image a frame with a sighting, one category a model, one annotation a sighting; annotations as they are read,
/// images after them.
Status ExportCoco(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter, std::ostream& out);

}  // namespace victorious
