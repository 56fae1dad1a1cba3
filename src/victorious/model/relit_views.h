// Relit templates: the views of a CAD model under strong sunlight with cast shadows, relit (render/relight.h) from the
// renderings that the model stores. They are made on demand and cached, because the sun directions of a video are not
// known before, and all of them together would be many times the size of the model.
#pragma once

#include <cstddef>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/recognize/relit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Null for a model without stored renderings: one from photos.
/// @param max_kept  capacity of the cache, in templates of about 60 kB each. The least recently used ones are evicted
///                  and made again on demand.
/// Error: kInvalidArgument, the model has options that this version does not know.
Expected<std::unique_ptr<const RelitTemplateSource>> MakeRelitViews(const ObjectModel& model,
                                                                    std::size_t max_kept = 1000);

}  // namespace victorious
