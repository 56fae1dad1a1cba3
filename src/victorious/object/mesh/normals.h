// Private to mesh/: computes missing vertex normals, area-weighted with a crease angle.
#pragma once

#include "victorious/types/mesh.h"

namespace victorious {

/// Recomputes the normals of every triangle with a vertex normal that is not of unit length (a missing one is zero).
/// Each of its corners becomes a separate vertex. The normal there is the area-weighted mean over the recomputed
/// triangles at the same point that meet this triangle at less than 40 degrees (crease angle). Smooth surfaces are
/// shaded smoothly; edges stay sharp.
void FillMissingNormals(Mesh& mesh);

}  // namespace victorious
