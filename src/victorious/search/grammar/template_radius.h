// grammar/, shared by the cascade and its reference: the size of a template, for R by scale (CascadeRadius::kScale).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "victorious/types/feature_set.h"

namespace victorious {

/// The largest distance of a template keypoint from the centroid of all, px.
inline double TemplateRadius(std::span<const Keypoint> template_keypoints) {
  double x = 0;
  double y = 0;
  for (const Keypoint& keypoint : template_keypoints) {
    x += keypoint.x / static_cast<double>(template_keypoints.size());
    y += keypoint.y / static_cast<double>(template_keypoints.size());
  }
  double radius = 0;
  for (const Keypoint& keypoint : template_keypoints) {
    radius = std::max(radius, std::hypot(keypoint.x - x, keypoint.y - y));
  }
  return radius;
}

}  // namespace victorious
