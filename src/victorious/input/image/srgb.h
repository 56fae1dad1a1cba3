// The sRGB transfer function (IEC 61966-2-1) and its inverse; both map [0, 1] to [0, 1].
#pragma once

#include <cmath>

namespace victorious {

template <typename Number>
Number LinearFromSrgb(Number srgb) {
  return srgb <= Number(0.04045) ? srgb / Number(12.92) : std::pow((srgb + Number(0.055)) / Number(1.055), Number(2.4));
}

template <typename Number>
Number SrgbFromLinear(Number linear) {
  return linear <= Number(0.0031308) ? Number(12.92) * linear
                                     : Number(1.055) * std::pow(linear, Number(1) / Number(2.4)) - Number(0.055);
}

}  // namespace victorious
