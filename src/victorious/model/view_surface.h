// A rendering kept in a model file so that it can be lit anew (render/relight.h): picture, depth, camera. The bytes are
// those of docs/formats/model.md, section surfaces.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/render/relight.h"

namespace victorious {

struct ViewSurface {
  cv::Mat grey;      ///< CV_8UC1, sRGB, before a plain background
  SeenSurface seen;  ///< the model is the world
};

/// @param surface  of one size, the object in it
Expected<std::vector<std::byte>> EncodeSurface(const ViewSurface& surface);

/// Error: kDataLoss, bytes that no EncodeSurface() made; `name` says of what.
Expected<ViewSurface> DecodeSurface(std::span<const std::byte> bytes, const std::string& name);

}  // namespace victorious
