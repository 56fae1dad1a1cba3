#include "victorious/category/network/network_request.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "victorious/base/packed_bytes.h"

namespace victorious {
namespace {

std::span<const std::byte> BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

Error NoAnswer() { return {ErrorCode::kDataLoss, "the network's process gave an answer without a meaning"}; }

}  // namespace

std::string PackNetworkFiles(const NetworkFiles& files) {
  ByteWriter writer;
  writer.PutText(files.network);
  writer.PutText(files.weights);
  return writer.TakeText();
}

NetworkFiles UnpackNetworkFiles(std::string_view bytes) {
  ByteReader reader(BytesOf(bytes));
  NetworkFiles files;
  files.network = reader.GetText();
  files.weights = reader.GetText();
  return files;
}

std::string PackRun(const NetworkRun& run) {
  ByteWriter writer;
  writer.Put(run.input.cols);
  writer.Put(run.input.rows);
  writer.Put(run.channels);
  for (std::size_t c = 0; c < run.mean.size(); ++c) {
    writer.Put(run.mean[c]);
    writer.Put(run.deviation[c]);
  }
  const cv::Mat pixels = run.input.isContinuous() ? run.input : run.input.clone();
  writer.PutItems(std::span<const std::uint8_t>(pixels.data, pixels.total() * pixels.elemSize()));
  return writer.TakeText();
}

NetworkRun UnpackRun(std::string_view bytes) {
  ByteReader reader(BytesOf(bytes));
  NetworkRun run;
  const auto width = reader.Get<int>();
  const auto height = reader.Get<int>();
  run.channels = reader.GetEnum(ChannelOrder::kBgr);
  for (std::size_t c = 0; c < run.mean.size(); ++c) {
    run.mean[c] = reader.Get<double>();
    run.deviation[c] = reader.Get<double>();
  }
  const std::vector<std::uint8_t> pixels = reader.GetItems<std::uint8_t>();
  run.input = cv::Mat(height, width, CV_8UC3);
  if (pixels.size() == run.input.total() * run.input.elemSize()) {
    std::memcpy(run.input.data, pixels.data(), pixels.size());
  }
  return run;
}

std::string PackTensors(const std::vector<NetworkTensor>& tensors) {
  ByteWriter writer;
  writer.Put(std::uint64_t{tensors.size()});
  for (const NetworkTensor& tensor : tensors) {
    writer.PutItems(std::span<const int>(tensor.shape));
    writer.PutItems(std::span<const float>(tensor.values));
  }
  return writer.TakeText();
}

Expected<std::vector<NetworkTensor>> UnpackTensors(std::string_view bytes) {
  constexpr std::size_t kMaxDimensions = 8;
  ByteReader reader(BytesOf(bytes));
  std::vector<NetworkTensor> tensors(reader.GetCount(2 * sizeof(std::uint64_t)));
  for (NetworkTensor& tensor : tensors) {
    tensor.shape = reader.GetItems<int>();
    tensor.values = reader.GetItems<float>();
    std::size_t count = 1;
    for (const int side : tensor.shape) {
      if (side <= 0 || count > kMaxOutputValues) return std::unexpected(NoAnswer());
      count *= static_cast<std::size_t>(side);
    }
    if (tensor.shape.size() > kMaxDimensions || count != tensor.values.size()) return std::unexpected(NoAnswer());
  }
  if (!reader.IsAtEnd()) return std::unexpected(NoAnswer());
  return tensors;
}

}  // namespace victorious
