// The size of the image that a network's file says it takes: of ONNX the shape of its input, of darknet the width and
// height of its description. Reads only what leads there.
// Source: onnx.proto of the ONNX project, and the encoding of Protocol Buffers.
#pragma once

#include <string_view>

#include <opencv2/core/types.hpp>

#include "victorious/category/network/network_request.h"

namespace victorious {

/// 0x0 if the file does not say, or is none. Safe for any bytes.
[[nodiscard]] cv::Size FindInputSize(const NetworkFiles& files);

[[nodiscard]] cv::Size FindOnnxInputSize(std::string_view onnx);
[[nodiscard]] cv::Size FindDarknetInputSize(std::string_view description);

}  // namespace victorious
