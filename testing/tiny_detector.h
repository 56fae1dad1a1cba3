// A detection network made for tests: one convolution, which finds what is red. Its outputs are those of a FastestDet
// of two classes, "red" and "blue"; a cell of 16 px is an object if it is of one of these colours.
#pragma once

#include <string>

namespace victorious::testing {

/// The bytes of its ONNX file. @param side_px  of its input, a multiple of 16
/// @param padding_px  around the input: without sense, but for a network that takes much memory
[[nodiscard]] std::string TinyDetectorOnnx(int side_px, int padding_px = 0);

/// "red\nblue\n"
[[nodiscard]] std::string TinyDetectorClasses();

}  // namespace victorious::testing
