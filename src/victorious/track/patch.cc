#include "victorious/track/patch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "victorious/base/check.h"

namespace victorious {
namespace {

// Bilinear interpolation with a replicated border.
float Sample(const cv::Mat& grey, double x, double y) {
  const double u = std::clamp(x - 0.5, 0.0, grey.cols - 1.0);
  const double v = std::clamp(y - 0.5, 0.0, grey.rows - 1.0);
  const auto column = static_cast<int>(u);
  const auto row = static_cast<int>(v);
  const auto right = std::min(column + 1, grey.cols - 1);
  const auto a = static_cast<float>(u - column);
  const auto b = static_cast<float>(v - row);
  const auto* upper = grey.ptr<std::uint8_t>(row);
  const auto* lower = grey.ptr<std::uint8_t>(std::min(row + 1, grey.rows - 1));
  const float above = static_cast<float>(upper[column]) * (1 - a) + static_cast<float>(upper[right]) * a;
  const float below = static_cast<float>(lower[column]) * (1 - a) + static_cast<float>(lower[right]) * a;
  return above * (1 - b) + below * b;
}

}  // namespace

Patch::Patch(const cv::Mat& grey, const Eigen::Vector2d& centre, int side_px, const Eigen::Matrix2d& linear) {
  VICTORIOUS_CHECK(grey.type() == CV_8UC1 && !grey.empty() && side_px % 2 == 1);
  values_.reserve(static_cast<std::size_t>(side_px) * static_cast<std::size_t>(side_px));
  const int half = side_px / 2;
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      const Eigen::Vector2d position = centre + linear * Eigen::Vector2d(x, y);
      values_.push_back(Sample(grey, position.x(), position.y()));
    }
  }
  const float mean = std::accumulate(values_.begin(), values_.end(), 0.0F) / static_cast<float>(values_.size());
  float sum2 = 0;
  for (float& value : values_) {
    value -= mean;
    sum2 += value * value;
  }
  // A standard deviation below one grey level is sensor noise.
  flat_ = sum2 < static_cast<float>(values_.size());
  const float factor = flat_ ? 0.0F : 1.0F / std::sqrt(sum2);
  for (float& value : values_) value *= factor;
}

double Patch::NccScore(const Patch& other) const {
  VICTORIOUS_CHECK(values_.size() == other.values_.size());
  return std::inner_product(values_.begin(), values_.end(), other.values_.begin(), 0.0F);
}

}  // namespace victorious
