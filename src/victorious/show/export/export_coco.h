// COCO detection JSON.
#pragma once

#include <iosfwd>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Writes one COCO image per frame with a sighting, one category per model and one annotation per sighting. Streams the
/// annotations as they are read, and writes the images after them.
[[nodiscard]] Status ExportCoco(IndexStore& store, const Catalogue& catalogue, const SightingFilter& filter,
                                std::ostream& out);

}  // namespace victorious
