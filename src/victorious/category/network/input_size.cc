#include "victorious/category/network/input_size.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "victorious/base/text.h"
#include "victorious/category/network/detector_settings.h"

namespace victorious {
namespace {

// The fields of a message of Protocol Buffers, one after the other. Ends at the first byte that is none of a field.
class MessageFields {
 public:
  explicit MessageFields(std::string_view bytes) : rest_(bytes) {}

  struct Field {
    std::uint64_t number = 0;
    std::uint64_t value = 0;      // of a number
    std::string_view bytes = {};  // of a text or a message
  };

  std::optional<Field> Next() {
    const auto tag = TakeVarint();
    if (!tag) return std::nullopt;
    constexpr unsigned kTypeBits = 3;
    Field field{.number = *tag >> kTypeBits};
    switch (*tag & ((1U << kTypeBits) - 1)) {
      case 0: {
        const auto value = TakeVarint();
        if (!value) return std::nullopt;
        field.value = *value;
        return field;
      }
      case 1:
        return Skip(8) ? std::optional(field) : std::nullopt;
      case 2: {
        const auto size = TakeVarint();
        if (!size || *size > rest_.size()) return std::nullopt;
        field.bytes = rest_.substr(0, static_cast<std::size_t>(*size));
        rest_.remove_prefix(field.bytes.size());
        return field;
      }
      case 5:
        return Skip(4) ? std::optional(field) : std::nullopt;
      default:
        return std::nullopt;
    }
  }

 private:
  bool Skip(std::size_t bytes) {
    if (bytes > rest_.size()) return false;
    rest_.remove_prefix(bytes);
    return true;
  }

  std::optional<std::uint64_t> TakeVarint() {
    constexpr unsigned kBits = 7;
    constexpr unsigned kMaxBits = 64;
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < kMaxBits && !rest_.empty(); shift += kBits) {
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      value |= std::uint64_t{byte & 0x7fU} << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    return std::nullopt;
  }

  std::string_view rest_;
};

// The first message with this number; empty if there is none.
std::string_view FindMessage(std::string_view bytes, std::uint64_t number) {
  MessageFields fields(bytes);
  while (const auto field = fields.Next()) {
    if (field->number == number) return field->bytes;
  }
  return {};
}

cv::Size SizeOf(std::int64_t width, std::int64_t height) {
  const auto is_side = [](std::int64_t side) { return side >= kMinInputSide_px && side <= kMaxInputSide_px; };
  if (!is_side(width) || !is_side(height)) return {};
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace

cv::Size FindOnnxInputSize(std::string_view onnx) {
  constexpr std::uint64_t kGraph = 7;
  constexpr std::uint64_t kInput = 11;
  constexpr std::uint64_t kType = 2;
  constexpr std::uint64_t kTensorType = 1;
  constexpr std::uint64_t kShape = 2;
  constexpr std::size_t kDimensions = 4;
  constexpr std::int64_t kChannels = 3;
  MessageFields graph(FindMessage(onnx, kGraph));
  while (const auto input = graph.Next()) {
    if (input->number != kInput) continue;
    MessageFields shape(FindMessage(FindMessage(FindMessage(input->bytes, kType), kTensorType), kShape));
    std::vector<std::int64_t> sides;
    while (const auto dimension = shape.Next()) {
      if (sides.size() > kDimensions) break;
      MessageFields side(dimension->bytes);
      const auto value = side.Next();
      // A dimension may have a name instead of a number.
      sides.push_back(value && value->number == 1 ? static_cast<std::int64_t>(value->value) : 0);
    }
    // Files of older versions list the weights among the inputs.
    if (sides.size() != kDimensions || sides[0] > 1 || sides[1] != kChannels) continue;
    const cv::Size size = SizeOf(sides[3], sides[2]);
    if (!size.empty()) return size;
  }
  return {};
}

cv::Size FindDarknetInputSize(std::string_view description) {
  std::int64_t width = 0;
  std::int64_t height = 0;
  bool is_net = false;
  while (!description.empty()) {
    const std::string_view line = TrimBlanks(TakeLine(description));
    if (line.starts_with('[')) {
      if (is_net) break;
      is_net = line == "[net]" || line == "[network]";
      continue;
    }
    const std::size_t equals = line.find('=');
    if (!is_net || equals == std::string_view::npos) continue;
    const std::string_view key = TrimBlanks(line.substr(0, equals));
    const auto value = ParseInteger(TrimBlanks(line.substr(equals + 1)));
    if (key == "width") width = value.value_or(0);
    if (key == "height") height = value.value_or(0);
  }
  return SizeOf(width, height);
}

cv::Size FindInputSize(const NetworkFiles& files) {
  return files.IsDarknet() ? FindDarknetInputSize(files.network) : FindOnnxInputSize(files.network);
}

}  // namespace victorious
