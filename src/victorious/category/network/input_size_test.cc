#include "victorious/category/network/input_size.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace victorious {
namespace {

std::string Varint(std::uint64_t value) {
  std::string bytes;
  while (value >= 0x80) {
    bytes += static_cast<char>(value | 0x80);
    value >>= 7;
  }
  return bytes + static_cast<char>(value);
}

std::string Message(std::uint64_t number, const std::string& bytes) {
  return Varint(number << 3 | 2) + Varint(bytes.size()) + bytes;
}

// A graph's input of this shape; 0: a dimension with a name.
std::string Input(const std::vector<std::uint64_t>& shape) {
  std::string dimensions;
  for (const std::uint64_t side : shape) {
    dimensions += Message(1, side == 0 ? Message(2, "batch") : Varint(1 << 3) + Varint(side));
  }
  return Message(11,
                 Message(1, "images") + Message(2, Message(1, Varint(1 << 3) + Varint(1) + Message(2, dimensions))));
}

std::string Onnx(const std::string& inputs) {
  return Varint(1 << 3) + Varint(8) + Message(2, "maker") + Message(7, Message(2, "graph") + inputs);
}

TEST(FindInputSize, IsThatOfTheInputOfImages) {
  EXPECT_EQ(FindOnnxInputSize(Onnx(Input({1, 3, 320, 640}))), cv::Size(640, 320));
  EXPECT_EQ(FindOnnxInputSize(Onnx(Input({0, 3, 416, 416}))), cv::Size(416, 416));
  EXPECT_EQ(FindOnnxInputSize(Onnx(Input({16, 3, 3, 3}) + Input({1, 3, 352, 352}))), cv::Size(352, 352));
}

TEST(FindInputSize, IsEmptyWhereTheFileDoesNotSay) {
  EXPECT_TRUE(FindOnnxInputSize(Onnx(Input({1, 3, 0, 0}))).empty());
  EXPECT_TRUE(FindOnnxInputSize(Onnx(Input({1, 1, 64, 64}))).empty());
  EXPECT_TRUE(FindOnnxInputSize(Onnx(Input({1, 3, 64, 1U << 30}))).empty());
  EXPECT_TRUE(FindOnnxInputSize("").empty());
  const std::string whole = Onnx(Input({1, 3, 64, 96}));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(FindOnnxInputSize(whole.substr(0, size)).empty()) << size;
  }
}

TEST(FindInputSize, OfDarknetIsOfItsFirstSection) {
  EXPECT_EQ(FindDarknetInputSize("# a net\n[net]\nbatch=1\nwidth = 608\nheight=416\r\n[convolutional]\nwidth=9\n"),
            cv::Size(608, 416));
  EXPECT_TRUE(FindDarknetInputSize("[convolutional]\nwidth=608\nheight=608\n").empty());
  EXPECT_TRUE(FindDarknetInputSize("[net]\nwidth=608\nheight=many\n").empty());
}

}  // namespace
}  // namespace victorious
