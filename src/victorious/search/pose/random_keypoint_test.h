// Keypoints of the worlds in which the tests of pose/ estimate poses.
#pragma once

#include <cmath>

#include "victorious/base/random.h"
#include "victorious/geometry/angles.h"
#include "victorious/geometry/box.h"
#include "victorious/geometry/polygon.h"
#include "victorious/types/feature_set.h"

namespace victorious {

/// Of the scene, px.
inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
/// Of the template, px.
inline const Polygon kOutline = BoxCorners({0, 0, 200, 100});

/// Anywhere in an image of this size, with a scale of 1.5 to 12 px.
inline Keypoint RandomKeypoint(Random& random, double width, double height) {
  return {static_cast<float>(random.Uniform() * width), static_cast<float>(random.Uniform() * height),
          static_cast<float>(1.5 * std::exp2(3 * random.Uniform())),
          static_cast<float>(2 * kPi * random.Uniform() - kPi)};
}

}  // namespace victorious
