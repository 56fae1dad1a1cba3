// Fuzzes what the program itself reads of detection networks: the size of the input in their files, the file of an
// imported detector, the answer of the process that runs them, and outputs of any shape and value.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "testing/tiny_detector.h"
#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/base/file.h"
#include "victorious/category/network/decode_outputs.h"
#include "victorious/category/network/detector_file.h"
#include "victorious/category/network/input_size.h"
#include "victorious/category/network/output_layout.h"

namespace {

constexpr std::size_t kHeaderSize = 32;
constexpr std::size_t kClasses = 2;

void CheckSize(cv::Size size) {
  VICTORIOUS_CHECK(size.empty() ||
                   (size.width <= victorious::kMaxInputSide_px && size.height >= victorious::kMinInputSide_px));
}

void ParseFile(std::span<const std::byte> bytes) {
  const auto model = victorious::ParseDetector(bytes, "fuzz");
  if (!model) {
    VICTORIOUS_CHECK(model.error().message.find('\n') == std::string::npos);
    return;
  }
  VICTORIOUS_CHECK(victorious::ParseDetector(EncodeDetector(*model), "again").has_value());
}

// Any layout on tensors that the bytes name.
void Decode(std::string_view bytes) {
  const auto tensors = victorious::UnpackTensors(bytes);
  if (!tensors) return;
  std::vector<std::vector<int>> shapes;
  for (const auto& tensor : *tensors) shapes.push_back(tensor.shape);
  (void)victorious::RecogniseLayout(shapes, kClasses, {64, 64});
  for (const auto& [layout, text] : victorious::kDetectorLayoutTexts) {
    victorious::DetectorSettings settings = victorious::DefaultSettings(layout);
    settings.width = settings.height = 64;
    const auto found = victorious::DecodeOutputs(*tensors, settings, kClasses);
    if (!found) continue;
    for (const victorious::NetworkBox& one : *found) {
      VICTORIOUS_CHECK(one.category < kClasses && one.score >= settings.min_score && one.score <= 1);
      VICTORIOUS_CHECK(std::isfinite(one.box.x) && std::isfinite(one.box.y) && !one.box.IsEmpty());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::span<const std::byte> input = std::as_bytes(std::span(data, size));
  CheckSize(victorious::FindOnnxInputSize(text));
  CheckSize(victorious::FindDarknetInputSize(text));
  (void)victorious::ParseClassList(text, "classes");
  Decode(text);
  ParseFile(input);
  if (size >= kHeaderSize) {  // the payload with a matching size and checksum
    std::vector<std::byte> mended(input.begin(), input.end());
    const std::uint64_t payload_size = size - kHeaderSize;
    const std::uint64_t checksum = victorious::Checksum(input.subspan(kHeaderSize));
    std::memcpy(mended.data() + 16, &payload_size, sizeof(payload_size));
    std::memcpy(mended.data() + 24, &checksum, sizeof(checksum));
    ParseFile(mended);
  }
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  const std::string onnx = victorious::testing::TinyDetectorOnnx(64);
  victorious::DetectorModel model{.program_version = "1", .source = "tiny.onnx", .classes = {"red", "blue"}};
  model.files.network = onnx;
  const std::vector<std::byte> file = EncodeDetector(model);
  std::vector<std::string> seeds = {onnx,
                                    {reinterpret_cast<const char*>(file.data()), file.size()},
                                    "[net]\nwidth=608\nheight=416\n[yolo]\n",
                                    victorious::testing::TinyDetectorClasses()};
  const std::vector<std::vector<std::vector<int>>> outputs = {
      {{1, 84, 7}}, {{1, 6, 84}},           {{1, 252, 7}},      {{1, 7, 4, 4}}, {{1, 1, 9, 7}},
      {{1, 20, 6}}, {{1, 9, 3}, {1, 9, 4}}, {{12, 7}, {48, 7}}, {{1, 84, 34}}};
  for (const auto& shapes : outputs) {
    std::vector<victorious::NetworkTensor> tensors;
    for (const std::vector<int>& shape : shapes) {
      std::size_t count = 1;
      for (const int side : shape) count *= static_cast<std::size_t>(side);
      tensors.push_back({.shape = shape, .values = std::vector<float>(count, 0.9F)});
    }
    seeds.push_back(victorious::PackTensors(tensors));
  }
  return seeds;
}
