// Only for tests: a small textured model made of a mesh, of few views.
#pragma once

#include "victorious/types/object_model.h"

namespace victorious::testing {

/// A slab with blocks of different sizes and heights on it, 4 m long: views every 30 degrees down to 60 off nadir.
const ObjectModel& WaffleModel();

}  // namespace victorious::testing
