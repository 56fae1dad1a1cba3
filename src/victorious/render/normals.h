// Private to render/: normals for triangles that came without.
#pragma once

#include "victorious/render/mesh.h"

namespace victorious {

/// Recomputes the normals of every triangle with a corner whose normal is not of unit length (missing: zero). Its
/// corners become vertices of their own, whose normal is the mean, weighted by area, of those triangles about the same
/// point (of the ones to recompute) that meet this one at less than 40 degrees: smooth where the surface is, sharp at
/// edges.
void FillMissingNormals(Mesh& mesh);

}  // namespace victorious
