// Relights a rendering for another sun from its grey image and depth map; the mesh is not needed.
// object/model/relit_views.h makes relit templates with it.
//
// The depth map gives the 3D point of each pixel and, by finite differences, its normal n. The irradiance under a light
// (renderer.h), with u up and s the direction to the sun, is
//   E = ground + (sky - ground)(1 + n.u)/2 + sun max(0, n.s) v
// The rendering has v = 1 (no shadows), so albedo = linear grey / E(before), and the relit image is albedo * E(after).
// The sun visibility v under `after` comes from shadow mapping: the depth map of another rendering of the object, made
// from near the direction of the sun.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/camera.h"
#include "victorious/geometry/view_sphere.h"
#include "victorious/object/render/renderer.h"
#include "victorious/types/surface_point.h"

namespace victorious {

/// The light of a clear day: the sun contributes about two thirds of the irradiance of a surface that faces it.
/// @param sun  direction from the object to the sun, in the model frame (the world frame is the model frame)
[[nodiscard]] Light ClearDayLight(const ViewDirection& sun);

/// The depth map of an object with the camera that it was rendered from.
struct PosedDepthMap {
  PosedCamera camera;
  cv::Mat depth_m;  ///< CV_32FC1, size of the camera image, depth along the optical axis; NaN for background
};

/// @param grey       CV_8UC1, sRGB, size of `depth_map`, rendered under `before`
/// @param depth_map  of the same rendering
/// @param before     must be without shadows
/// @param after      its sun casts shadows, regardless of Light::shadows
/// @param from_sun   depth map of the whole object from near the direction of the sun of `after`
/// @return           CV_8UC1, the image under `after`; pixels without depth are copied from `grey`
[[nodiscard]] cv::Mat Relight(const cv::Mat& grey, const PosedDepthMap& depth_map, const Light& before,
                              const Light& after, const PosedDepthMap& from_sun);

/// The points of a rendering's pixels, with normals and albedo as above; positions in the world frame. Row by row,
/// without the pixels of the background.
/// @param light  of the rendering; without shadows
[[nodiscard]] std::vector<SurfacePoint> ReadSurface(const cv::Mat& grey, const PosedDepthMap& depth_map,
                                                    const Light& light);

}  // namespace victorious
