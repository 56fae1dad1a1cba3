// The experiments of matches and the cascade, thesis sections 3.3 and 3.5: what experiment.cc lists.
#pragma once

#include "victorious/evaluate/experiments/experiment.h"

namespace victorious {

Expected<Report> RunTable32(const ExperimentSettings& settings);

}  // namespace victorious
