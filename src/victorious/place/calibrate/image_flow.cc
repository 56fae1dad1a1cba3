#include "victorious/place/calibrate/image_flow.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "victorious/base/median.h"

namespace victorious {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<ImageFlow> FitImageFlow(std::span<const PointPair> corners, const cv::Size& image) {
  constexpr std::size_t kMinCorners = 20;
  constexpr int kRounds = 10;
  constexpr double kMinScale_px = 0.05;
  constexpr double kMinRcond = 1e-6;
  if (corners.size() < kMinCorners) return std::nullopt;
  const Vector2d middle(image.width / 2.0, image.height / 2.0);
  const double unit_px = std::max(image.width, image.height) / 2.0;  // for the condition of the equations
  std::vector<double> weights(corners.size(), 1);
  Eigen::Matrix<double, 3, 2> map;
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d normal = Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d at = (corners[i].source - middle) / unit_px;
      const Vector3d row(1, at.x(), at.y());
      normal += weights[i] * row * row.transpose();
      right += weights[i] * row * (corners[i].target - corners[i].source).transpose();
    }
    const Eigen::LDLT<Matrix3d> solver(normal);
    if (solver.info() != Eigen::Success || !(solver.rcond() > kMinRcond)) return std::nullopt;
    map = solver.solve(right);
    std::vector<double> residuals_px;
    for (const PointPair& corner : corners) {
      const Vector2d at = (corner.source - middle) / unit_px;
      residuals_px.push_back((corner.target - corner.source - map.transpose() * Vector3d(1, at.x(), at.y())).norm());
    }
    const double scale_px = std::max(kMinScale_px, Median(residuals_px) / kRayleighMedian);
    constexpr double kCauchy = 2.4;  // 95 % efficiency for normal errors
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const double sigmas = residuals_px[i] / (kCauchy * scale_px);
      weights[i] = 1 / (1 + sigmas * sigmas);
    }
  }
  return ImageFlow{.centre_px = map.row(0), .gradient = map.bottomRows<2>().transpose() / unit_px};
}

}  // namespace victorious
