// A CAD model without colours, painted with what a picture shows of it.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/render/mesh.h"

namespace victorious {

/// What the picture shows of the mesh has the picture's colours, the rest is grey. Triangles are cut until each is
/// small in the picture, so that perspective bends no texture.
/// @param bgr     CV_8UC3
/// @param camera  of the picture; the mesh is the world
/// Errors: kInternal where nothing can render.
Expected<Mesh> PaintedMesh(const Mesh& mesh, const cv::Mat& bgr, const PosedCamera& camera);

}  // namespace victorious
