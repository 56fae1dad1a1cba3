// Textures a CAD model without colours by projecting an image onto it (projective texture mapping).
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/geometry/camera.h"
#include "victorious/types/mesh.h"

namespace victorious {

/// Returns the mesh with the image as its texture where the image shows it; the rest is grey. Triangles are subdivided
/// until their sides are at most 8 px in the image, so that affine texture interpolation is accurate.
/// @param bgr     the image, CV_8UC3
/// @param camera  of the image; the mesh frame is the world frame
/// Error: kInternal if no renderer is available.
[[nodiscard]] Expected<Mesh> ProjectTexture(const Mesh& mesh, const cv::Mat& bgr, const PosedCamera& camera);

}  // namespace victorious
