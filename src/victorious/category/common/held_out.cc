#include "victorious/category/common/held_out.h"

#include <algorithm>
#include <map>
#include <vector>

namespace victorious {

Calibration CalibrateHeldOut(std::span<const CategoryExample> examples, std::span<const int> targets,
                             const Eigen::VectorXd& scores) {
  std::vector<double> used;
  std::vector<bool> positive;
  std::map<int, double> highest;  // maximum score of each negative image
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (targets[i] == 0 || !examples[i].used_for_calibration) continue;
    const double score = scores(static_cast<Eigen::Index>(i));
    if (targets[i] > 0) {
      used.push_back(score);
      positive.push_back(true);
    } else if (const auto [at, is_new] = highest.try_emplace(examples[i].image, score); !is_new) {
      at->second = std::max(at->second, score);
    }
  }
  for (const auto& [image, score] : highest) {
    used.push_back(score);
    positive.push_back(false);
  }
  constexpr double kCertain = 20;  // a probability of 1 - 2e-9
  if (std::ranges::count(positive, false) == 0) return {.slope = 1, .offset = kCertain};
  if (std::ranges::count(positive, true) == 0) return {.slope = 1, .offset = -kCertain};
  return Calibrate(used, positive);
}

}  // namespace victorious
