// The experiments on tracking, geolocation and the whole system (thesis, chapters 4 and 5); experiment.cc registers
// them.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

Expected<Report> RunFigure41(const ExperimentSettings& settings);
Expected<Report> RunFigure42(const ExperimentSettings& settings);
Expected<Report> RunFigure43(const ExperimentSettings& settings);
Expected<Report> RunFigure44(const ExperimentSettings& settings);
Expected<Report> RunFigure45(const ExperimentSettings& settings);
Expected<Report> RunFigure52(const ExperimentSettings& settings);
Expected<Report> RunFigure53(const ExperimentSettings& settings);
Expected<Report> RunFigure54(const ExperimentSettings& settings);
Expected<Report> RunFigure55(const ExperimentSettings& settings);

}  // namespace victorious
