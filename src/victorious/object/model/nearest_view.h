// Which view of a CAD model looks at the object from nearest to a direction.
#pragma once

#include <cstddef>

#include "victorious/geometry/view_direction.h"
#include "victorious/types/object_model.h"

namespace victorious {

/// The index of the view whose direction makes the smallest angle with `direction`; 0 if no view has angles.
[[nodiscard]] std::size_t NearestView(const ObjectModel& model, const ViewDirection& direction);

}  // namespace victorious
