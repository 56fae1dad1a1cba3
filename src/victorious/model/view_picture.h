// A rendering's inside as points with a brightness: what is compared with a scene where a pose
// is in doubt (recognize/likeness.h).
#pragma once

#include "victorious/model/view_surface.h"
#include "victorious/types/lit_templates.h"

namespace victorious {

/// @param shrink  the scene shows the object so many times smaller than the rendering, > 0
/// Some 300 points, each the mean of the object about it. Without points where hardly any of the object is away from
/// its rim.
[[nodiscard]] ViewPicture PictureOf(const ViewSurface& surface, double shrink);

}  // namespace victorious
