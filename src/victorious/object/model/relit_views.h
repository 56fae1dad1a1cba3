// Relit templates: the views of a CAD model under strong sunlight with cast shadows, relit (object/render/relight.h)
// from the renderings that the model stores. They are made on demand and cached, because the sun directions of a video
// are not known before, and all of them together would be many times the size of the model.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/object/features/relit_templates.h"
#include "victorious/object/model/relit_template_folder.h"
#include "victorious/object/model/relit_view_cache.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Null for a model without stored renderings: one from photos.
/// @param cache  may be shared with other models: one budget for all; templates of about 10 kB (half resolution) and
///               30 kB are made again when they have been evicted
/// Error: kInvalidArgument, the model has options that this version does not know.
[[nodiscard]] Expected<std::unique_ptr<const RelitTemplateSource>> MakeRelitViews(
    const ObjectModel& model, std::shared_ptr<RelitViewCache> cache = std::make_shared<RelitViewCache>());

/// The relit views of all models of a search, one entry per model, within one budget of RelitViewCache.
/// @param folder  of templates that were made before, and for those that are made; null: none
/// Errors: those of one model.
[[nodiscard]] Expected<std::vector<std::shared_ptr<const RelitTemplateSource>>> MakeRelitViews(
    std::span<const ObjectModel> models, const RelitTemplateFolder* folder = nullptr);

}  // namespace victorious
