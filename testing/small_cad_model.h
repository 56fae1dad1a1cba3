// For tests only: a small CAD model with relief and few views.
#pragma once

#include "victorious/geometry/view_sphere.h"
#include "victorious/types/object_model.h"

namespace victorious::testing {

/// A slab 4 m long with 40 blocks of different sizes and heights.
ObjectModel MakeSmallCadModel(const ViewSphereOptions& sphere);

/// The same with views every 30 degrees, off-nadir angles up to 60.
const ObjectModel& SmallCadModel();

}  // namespace victorious::testing
