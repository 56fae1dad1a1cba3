#include "victorious/category/network/network_runner.h"

#include <cstdint>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <opencv2/dnn.hpp>

#include "victorious/base/one_line.h"
#include "victorious/category/network/network_request.h"

namespace victorious {
namespace {

// OpenCV's reason without the place in its sources, which says nothing to a user.
Error FromException(const cv::Exception& exception, const char* what) {
  if (exception.code == cv::Error::StsNoMem) throw std::bad_alloc();
  constexpr std::size_t kMaxReason = 300;
  std::string reason = exception.err.substr(0, kMaxReason);
  if (reason.empty()) reason = "no reason given";
  return {ErrorCode::kUnsupported, OneLine(fmt::format("OpenCV's dnn cannot {} this network: {}", what, reason))};
}

// Channels as planes of numbers: 1 x 3 x rows x columns.
cv::Mat MakeBlob(const NetworkRun& run) {
  constexpr std::size_t kChannels = 3;
  const std::array<int, 4> shape = {1, static_cast<int>(kChannels), run.input.rows, run.input.cols};
  cv::Mat blob(static_cast<int>(shape.size()), shape.data(), CV_32F);
  const bool is_rgb = run.channels == ChannelOrder::kRgb;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto mean = static_cast<float>(run.mean[c]);
    const auto factor = static_cast<float>(1 / run.deviation[c]);
    const std::size_t source = is_rgb ? kChannels - 1 - c : c;
    float* to = blob.ptr<float>(0, static_cast<int>(c));
    for (int y = 0; y < run.input.rows; ++y) {
      const std::uint8_t* row = run.input.ptr<std::uint8_t>(y) + source;
      for (int x = 0; x < run.input.cols; ++x, row += kChannels) *to++ = (static_cast<float>(*row) - mean) * factor;
    }
  }
  return blob;
}

Expected<NetworkTensor> ToTensor(const cv::Mat& output) {
  if (output.depth() != CV_32F || output.total() == 0 || output.total() * output.channels() > kMaxOutputValues) {
    return Fail(ErrorCode::kUnsupported, "its outputs are not of numbers of 32 bits, or too many: it is no detector");
  }
  NetworkTensor tensor;
  for (int d = 0; d < output.dims; ++d) tensor.shape.push_back(output.size[d]);
  const cv::Mat whole = output.isContinuous() ? output : output.clone();
  const auto* first = reinterpret_cast<const float*>(whole.data);
  tensor.values.assign(first, first + whole.total());
  return tensor;
}

}  // namespace

struct NetworkRunner::Loaded {
  cv::dnn::Net net;
  std::vector<std::string> outputs;

  [[nodiscard]] static Expected<std::unique_ptr<Loaded>> Load(const NetworkFiles& files) {
    auto loaded = std::make_unique<Loaded>();
    loaded->net = files.IsDarknet() ? cv::dnn::readNetFromDarknet(files.network.data(), files.network.size(),
                                                                  files.weights.data(), files.weights.size())
                                    : cv::dnn::readNetFromONNX(files.network.data(), files.network.size());
    if (loaded->net.empty()) return Fail(ErrorCode::kDataLoss, "not a network");
    loaded->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    loaded->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    loaded->outputs = loaded->net.getUnconnectedOutLayersNames();
    if (loaded->outputs.empty()) return Fail(ErrorCode::kDataLoss, "a network without outputs");
    return loaded;
  }

  [[nodiscard]] Expected<std::vector<NetworkTensor>> Run(const NetworkRun& run) {
    net.setInput(MakeBlob(run));
    std::vector<cv::Mat> values;
    net.forward(values, outputs);
    std::vector<NetworkTensor> tensors;
    for (const cv::Mat& output : values) {
      VICTORIOUS_ASSIGN_OR_RETURN(NetworkTensor tensor, ToTensor(output));
      tensors.push_back(std::move(tensor));
    }
    return tensors;
  }
};

NetworkRunner::NetworkRunner() = default;
NetworkRunner::~NetworkRunner() = default;

Expected<std::string> NetworkRunner::Answer(std::string_view request) {
  const char kind = request.empty() ? '\0' : request.front();
  request.remove_prefix(request.empty() ? 0 : 1);
  const char* what = kind == kLoadRequest ? "read" : "run";
  try {
    if (kind == kLoadRequest) {
      VICTORIOUS_ASSIGN_OR_RETURN(loaded_, Loaded::Load(UnpackNetworkFiles(request)));
      return std::string();
    }
    if (kind != kRunRequest || !loaded_) return Fail(ErrorCode::kInternal, "a request without a meaning");
    VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<NetworkTensor> tensors, loaded_->Run(UnpackRun(request)));
    return PackTensors(tensors);
  } catch (const cv::Exception& exception) {
    return std::unexpected(FromException(exception, what));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kUnsupported,
                OneLine(fmt::format("OpenCV's dnn cannot {} this network: {}", what, exception.what())));
  }
}

}  // namespace victorious
