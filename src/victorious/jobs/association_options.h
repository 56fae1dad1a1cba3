// How the objects of an index are made: the parameters of data association and the ground, which the index keeps with
// the objects, so that they can be made anew.
#pragma once

#include <memory>

#include "victorious/base/error.h"
#include "victorious/base/warning_sink.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/place/associate/object_options.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// Opens the ground, and has the options kept with the objects: of the terrain the whole path.
/// Errors: those of MakeGround.
[[nodiscard]] Expected<ObjectOptions> PrepareAssociation(ObjectOptions objects, const GroundOptions& ground,
                                                         const WarningSink& warn);

/// Those by which the present objects of an index were made; the defaults for an index that does not say, with a
/// warning. What the program did not have then is what it is by default. Errors: kDataLoss for options that cannot be
/// read; those of MakeGround and of the store.
[[nodiscard]] Expected<ObjectOptions> ReadAssociation(IndexStore& store, const WarningSink& warn);

}  // namespace victorious
