// The rendering of a view as stored in a model file: grey image, depth map, camera. Used for relighting
// (object/render/relight.h). docs/formats/model.md, section surfaces, describes the bytes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/object/render/relight.h"

namespace victorious {

struct ViewSurface {
  cv::Mat grey;             ///< CV_8UC1, sRGB, uniform background
  PosedDepthMap depth_map;  ///< of the same size; its world frame is the model frame
};

/// @param surface  image and depth map of the same size; depth is quantised to 65534 steps over the range of depths
/// Errors: those of EncodePng().
[[nodiscard]] Expected<std::vector<std::byte>> EncodeSurface(const ViewSurface& surface);

/// The inverse of EncodeSurface(). Error: kDataLoss, damaged bytes; the message starts with `name`.
[[nodiscard]] Expected<ViewSurface> DecodeSurface(std::span<const std::byte> bytes, const std::string& name);

/// The part of a rendering that shows the object: a fraction of its pixels.
struct SurfacePart {
  ViewSurface surface;    ///< of the part, with 2 px or more of background on each side; the camera's principal point
                          ///< is relative to the part
  cv::Point origin;       ///< of the part in the rendering, px; even, so that the rendering at half resolution has the
                          ///< part at half resolution; may be negative
  cv::Size rendering_px;  ///< size of the rendering
};

/// As DecodeSurface(), without the background.
[[nodiscard]] Expected<SurfacePart> DecodeSurfacePart(std::span<const std::byte> bytes, const std::string& name);

/// A SurfacePart at half resolution, kept in three bytes a pixel: a seventh of the memory of the part.
struct HalfSurfacePart {
  cv::Mat grey;         ///< CV_8UC1, the mean of four pixels
  cv::Mat depth_codes;  ///< CV_16UC1, as stored: of one of the four pixels, because the mean depth of two surfaces lies
                        ///< on neither; 0: none
  PosedCamera camera;
  double nearest_m = 0;   ///< depth of code 1
  double m_per_step = 0;  ///< between two codes
  cv::Point origin;       ///< of the part in the rendering at half resolution, px; may be negative
  cv::Size rendering_px;  ///< size of the rendering, at full resolution

  [[nodiscard]] ViewSurface Surface() const;
};

/// The part of a rendering that shows the object, at half resolution. Error: that of DecodeSurface().
[[nodiscard]] Expected<HalfSurfacePart> DecodeHalfSurfacePart(std::span<const std::byte> bytes,
                                                              const std::string& name);

}  // namespace victorious
