// A limit on the images that this process decodes, for processes that read hostile files with little memory.
#pragma once

#include <cstdint>

namespace victorious {

/// Makes ReadImage and DecodeImage (image_file.h) refuse larger images before they decode them, from now on and in the
/// whole process. Call it before other threads read images.
/// @param pixels  at most 2^28, the limit without this call
void LimitImagePixels(std::uint64_t pixels);

}  // namespace victorious
