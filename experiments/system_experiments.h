// The experiments on tracking, geolocation and the whole system (thesis, chapters 4 and 5); experiment.cc registers
// them.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

[[nodiscard]] Expected<Report> RunFigure41(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure42(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure43(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure44(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure45(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure52(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure53(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure54(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure55(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable51(const ExperimentSettings& settings);

}  // namespace victorious
