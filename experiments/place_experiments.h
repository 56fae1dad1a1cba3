// The experiments on geolocation with real data and known truth. Each is implemented in the file of its name.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

[[nodiscard]] Expected<Report> RunTableCheyenne(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableControlPoints(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableBrighton(const ExperimentSettings& settings);

}  // namespace victorious
