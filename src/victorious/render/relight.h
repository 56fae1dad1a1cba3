// A rendering lit anew, without its mesh: what a picture and its depth tell is enough for another sun.
//
// The depth gives each pixel's place and, by differences, its normal n. The picture was rendered under `before`, so the
// albedo is its linear value over the irradiance of then, E = ground + (sky - ground)(1 + n.u)/2 + sun max(0, n.s)
// (renderer.h), and the picture under `after` is the albedo times the irradiance of now. What the sun of `after`
// reaches is read from the depth seen from near the sun: another rendering of the same object.
#pragma once

#include <opencv2/core/mat.hpp>

#include "victorious/geometry/camera.h"
#include "victorious/render/renderer.h"
#include "victorious/render/view_sphere.h"

namespace victorious {

/// A clear day: of what a white surface in the sun reflects the sun gives some two thirds.
/// @param sun  where it stands; the model is the world
[[nodiscard]] Light ClearDay(const ViewDirection& sun);

/// What one camera sees of an object.
struct SeenSurface {
  PosedCamera camera;
  cv::Mat depth_m;  ///< CV_32FC1, of the camera's size, along the optical axis; NaN where there is nothing
};

/// @param grey        CV_8UC1, sRGB, of `seen`'s size, rendered under `before`
/// @param before      without shadows
/// @param after       its sun shades what it does not reach, whatever Light::shadows
/// @param from_sun    the object seen from near the sun of `after`, all of it
/// @return            the picture under `after`; as before where there is no depth
[[nodiscard]] cv::Mat Relight(const cv::Mat& grey, const SeenSurface& seen, const Light& before, const Light& after,
                              const SeenSurface& from_sun);

}  // namespace victorious
