// Samples a rendering of the object as 3D points with a brightness. The NCC check of uncertain poses
// (search/recognize/ncc_rescoring.h) projects them into the scene and compares the brightness.
#pragma once

#include "victorious/object/features/relit_templates.h"
#include "victorious/object/model/view_surface.h"

namespace victorious {

/// Samples about 300 points on a regular grid inside the object's outline. The brightness of a point is a Gaussian mean
/// over object pixels only.
/// @param shrink  size of the object in the rendering over its size in the scene, > 0
/// @return without points if fewer than 40 samples are more than 3 scene pixels inside the outline
[[nodiscard]] ViewAppearance SampleTemplatePoints(const ViewSurface& surface, double shrink);

}  // namespace victorious
