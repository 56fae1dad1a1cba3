// A CAD model's views under a hard sun, made from the renderings that the model keeps when they are first asked for:
// which suns a video needs is known only then, and all of them would be many times the model.
#pragma once

#include <cstddef>
#include <memory>

#include "victorious/base/error.h"
#include "victorious/types/lit_templates.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// Nothing for a model that keeps no renderings (photos, or made by an earlier version).
/// @param most_kept  in memory, of some 60 kB each: the longest unused are forgotten, and made again if asked for.
/// Error: kInvalidArgument, options in the model that this version does not know.
Expected<std::unique_ptr<const LitTemplates>> MakeLitViews(const ObjectModel& model, std::size_t most_kept = 1000);

}  // namespace victorious
