// What a program asks the process that runs a network (network_runner.h), and the answers, as bytes. Both ends are of
// one build. A network may have taken the process over: what reads the answers here checks them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "victorious/base/error.h"
#include "victorious/category/network/detector_settings.h"
#include "victorious/category/network/network_tensor.h"

namespace victorious {

/// The name of the function of victorious-decoder (base/isolated_main.h) that runs networks. A request is one of these
/// characters, and what it asks for.
inline constexpr std::string_view kRunNetwork = "network";
inline constexpr char kLoadRequest = 'l';  ///< PackNetworkFiles; the answer is empty
inline constexpr char kRunRequest = 'r';   ///< PackRun; the answer is PackTensors

/// The values of all outputs of a network; more are refused.
inline constexpr std::size_t kMaxOutputValues = std::size_t{1} << 24;

/// The files of a network.
struct NetworkFiles {
  std::string network;  ///< ONNX; or darknet's description (cfg), where there are weights
  std::string weights;  ///< darknet's; empty: an ONNX network

  [[nodiscard]] bool IsDarknet() const { return !weights.empty(); }
};

[[nodiscard]] std::string PackNetworkFiles(const NetworkFiles& files);
/// Only for what PackNetworkFiles made.
[[nodiscard]] NetworkFiles UnpackNetworkFiles(std::string_view bytes);

/// An image in the size of the input, and how its pixels become numbers.
struct NetworkRun {
  cv::Mat input;  ///< CV_8UC3, BGR
  ChannelOrder channels = ChannelOrder::kRgb;
  std::array<double, 3> mean = {};
  std::array<double, 3> deviation = {};
};

[[nodiscard]] std::string PackRun(const NetworkRun& run);
/// Only for what PackRun made.
[[nodiscard]] NetworkRun UnpackRun(std::string_view bytes);

[[nodiscard]] std::string PackTensors(const std::vector<NetworkTensor>& tensors);
/// Error: kDataLoss unless each has the values that its shape says.
[[nodiscard]] Expected<std::vector<NetworkTensor>> UnpackTensors(std::string_view bytes);

}  // namespace victorious
