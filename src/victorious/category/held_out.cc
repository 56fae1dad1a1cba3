#include "victorious/category/held_out.h"

#include <algorithm>
#include <vector>

namespace victorious {

Calibration CalibrateOn(std::span<const CategoryExample> examples, std::span<const int> targets,
                        const Eigen::VectorXd& scores) {
  std::vector<double> used;
  std::vector<bool> positive;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (targets[i] == 0 || !examples[i].calibrates) continue;
    used.push_back(scores(static_cast<Eigen::Index>(i)));
    positive.push_back(targets[i] > 0);
  }
  constexpr double kCertain = 20;  // a probability of 1 - 2e-9
  if (std::ranges::count(positive, false) == 0) return {.slope = 1, .offset = kCertain};
  if (std::ranges::count(positive, true) == 0) return {.slope = 1, .offset = -kCertain};
  return Calibrate(used, positive);
}

}  // namespace victorious
