#include "victorious/geometry/solvers/similarity.h"

#include <cmath>

namespace victorious {

std::optional<Similarity2> SolveSimilarity(std::span<const PointPair> pairs, std::span<const double> weights) {
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double total = 0;
  Eigen::Vector2d source_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    total += weight(i);
    source_mean += weight(i) * pairs[i].source;
    target_mean += weight(i) * pairs[i].target;
  }
  if (!(total > 0)) return std::nullopt;
  source_mean /= total;
  target_mean /= total;
  double spread = 0;
  double real = 0;
  double imaginary = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector2d s = pairs[i].source - source_mean;
    const Eigen::Vector2d t = pairs[i].target - target_mean;
    spread += weight(i) * s.squaredNorm();
    real += weight(i) * s.dot(t);
    imaginary += weight(i) * (s.x() * t.y() - s.y() * t.x());
  }
  Similarity2 similarity;
  similarity.scale = std::hypot(real, imaginary) / spread;
  if (!(spread > 0) || !(similarity.scale > 0) || !std::isfinite(similarity.scale)) return std::nullopt;
  similarity.rotation_rad = std::atan2(imaginary, real);
  similarity.translation = target_mean - similarity.Linear() * source_mean;
  return similarity;
}

}  // namespace victorious
