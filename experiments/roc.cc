#include "experiments/roc.h"

#include <algorithm>
#include <numeric>

#include "victorious/base/check.h"

namespace victorious {

std::vector<RocPoint> RocCurve(std::span<const double> scores, const std::vector<bool>& is_positive) {
  const auto positives = static_cast<double>(std::ranges::count(is_positive, true));
  const double negatives = static_cast<double>(is_positive.size()) - positives;
  VICTORIOUS_CHECK(scores.size() == is_positive.size() && positives > 0 && negatives > 0);
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  std::vector<RocPoint> curve(1);
  double detections = 0;
  double false_alarms = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    (is_positive[order[k]] ? detections : false_alarms) += 1;
    const bool last_of_its_score = k + 1 == order.size() || scores[order[k + 1]] != scores[order[k]];
    if (last_of_its_score) curve.push_back({false_alarms / negatives, detections / positives});
  }
  return curve;
}

double RocArea(std::span<const double> scores, const std::vector<bool>& is_positive) {
  const std::vector<RocPoint> curve = RocCurve(scores, is_positive);
  double area = 0;
  for (std::size_t i = 1; i < curve.size(); ++i)
    area += (curve[i].false_alarms - curve[i - 1].false_alarms) * (curve[i].detections + curve[i - 1].detections) / 2;
  return area;
}

double DetectionRateAt(std::span<const RocPoint> curve, double false_alarms) {
  double height = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const RocPoint& a = curve[i - 1];
    const RocPoint& b = curve[i];
    if (b.false_alarms <= false_alarms) {
      height = b.detections;
    } else if (a.false_alarms <= false_alarms) {
      const double share = (false_alarms - a.false_alarms) / (b.false_alarms - a.false_alarms);
      return a.detections + share * (b.detections - a.detections);
    }
  }
  return height;
}

}  // namespace victorious
