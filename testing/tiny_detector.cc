#include "testing/tiny_detector.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace victorious::testing {
namespace {

// Messages of Protocol Buffers.
std::string EncodeVarint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}

std::string NumberField(std::uint64_t field, std::uint64_t value) {
  return EncodeVarint(field << 3) + EncodeVarint(value);
}

std::string BytesField(std::uint64_t field, const std::string& bytes) {
  return EncodeVarint(field << 3 | 2) + EncodeVarint(bytes.size()) + bytes;
}

std::string TensorField(const std::string& name, std::span<const std::uint64_t> shape, std::span<const float> values) {
  std::string tensor;
  for (const std::uint64_t side : shape) tensor += NumberField(1, side);
  constexpr std::uint64_t kFloat = 1;
  tensor += NumberField(2, kFloat) + BytesField(8, name);
  tensor += BytesField(9, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  return BytesField(5, tensor);
}

std::string ShapedValue(std::uint64_t field, const std::string& name, std::span<const std::uint64_t> shape) {
  std::string sides;
  for (const std::uint64_t side : shape) sides += BytesField(1, NumberField(1, side));
  const std::string type = BytesField(1, NumberField(1, 1) + BytesField(2, sides));
  return BytesField(field, BytesField(1, name) + BytesField(2, type));
}

std::string IntegersAttribute(const std::string& name, std::span<const std::uint64_t> values) {
  constexpr std::uint64_t kIntegers = 7;
  std::string attribute = BytesField(1, name);
  for (const std::uint64_t value : values) attribute += NumberField(8, value);
  return BytesField(5, attribute + NumberField(20, kIntegers));
}

}  // namespace

std::string TinyDetectorClasses() { return "red\nblue\n"; }

std::string TinyDetectorOnnx(int side_px, int padding_px) {
  constexpr std::size_t kCell = 16;
  constexpr std::size_t kOutputs = 7;  // objectness, box, two classes
  const auto side = static_cast<std::uint64_t>(side_px);
  std::vector<float> weights(kOutputs * 3 * kCell * kCell, 0.0F);
  std::vector<float> bias(kOutputs, 0.0F);
  // The mean over the cell of a channel, in BGR of 0 to 1.
  const auto weigh = [&](std::size_t output, std::size_t channel, float weight) {
    for (std::size_t i = 0; i < kCell * kCell; ++i) {
      weights[(output * 3 + channel) * kCell * kCell + i] = weight / (kCell * kCell);
    }
  };
  weigh(0, 0, 1);  // red and blue, without green
  weigh(0, 1, -2);
  weigh(0, 2, 1);
  weigh(5, 2, 1);
  weigh(6, 0, 1);
  bias[1] = bias[2] = std::atanh(0.5F);  // the middle of the cell
  const float part = static_cast<float>(kCell) / static_cast<float>(side_px);
  bias[3] = bias[4] = std::log(part / (1 - part));  // of the cell's size

  const std::array<std::uint64_t, 2> kernel = {kCell, kCell};
  const auto padding = static_cast<std::uint64_t>(padding_px);
  const std::array<std::uint64_t, 4> pads = {padding, padding, padding, padding};
  const std::string node = BytesField(1, "images") + BytesField(1, "weights") + BytesField(1, "bias") +
                           BytesField(2, "out") + BytesField(3, "conv") + BytesField(4, "Conv") +
                           IntegersAttribute("kernel_shape", kernel) + IntegersAttribute("strides", kernel) +
                           IntegersAttribute("pads", pads);
  const std::array<std::uint64_t, 4> weight_shape = {kOutputs, 3, kCell, kCell};
  const std::array<std::uint64_t, 1> bias_shape = {kOutputs};
  const std::array<std::uint64_t, 4> input = {1, 3, side, side};
  const std::uint64_t cells = (side + 2 * padding) / kCell;
  const std::array<std::uint64_t, 4> output = {1, kOutputs, cells, cells};
  const std::string graph = BytesField(1, node) + BytesField(2, "tiny") +
                            TensorField("weights", weight_shape, weights) + TensorField("bias", bias_shape, bias) +
                            ShapedValue(11, "images", input) + ShapedValue(12, "out", output);
  return NumberField(1, 7) + BytesField(8, NumberField(2, 11)) + BytesField(7, graph);
}

}  // namespace victorious::testing
