#include "victorious/search/follow/image_motion.h"

#include <algorithm>
#include <array>

#include <Eigen/Core>

namespace victorious {

double FractionMoved(const Similarity2& motion, const cv::Size& size) {
  const Eigen::Vector2d diagonal(size.width, size.height);
  const std::array<Eigen::Vector2d, 5> points = {Eigen::Vector2d::Zero(), Eigen::Vector2d(size.width, 0),
                                                 Eigen::Vector2d(0, size.height), diagonal, diagonal / 2};
  double farthest_px = 0;
  for (const Eigen::Vector2d& point : points) {
    farthest_px = std::max(farthest_px, (motion.Apply(point) - point).norm());
  }
  return farthest_px / diagonal.norm();
}

}  // namespace victorious
