// The experiments on places, of real data whose truth is known, each in the file of its name.
#pragma once

#include "victorious/evaluate/experiments/experiment.h"

namespace victorious {

Expected<Report> RunTableCheyenne(const ExperimentSettings& settings);
Expected<Report> RunTableControlPoints(const ExperimentSettings& settings);
Expected<Report> RunTableBrighton(const ExperimentSettings& settings);

}  // namespace victorious
