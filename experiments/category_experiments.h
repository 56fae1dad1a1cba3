// The experiments on categories (thesis, sections 3.2.1 and 3.6). Each is implemented in the file of its name;
// experiment.cc registers them.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

[[nodiscard]] Expected<Report> RunFigure31(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure319(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure320(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure321(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable36(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable37(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableSteps(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableTwelve(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableBoxes(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableCad(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableWindows(const ExperimentSettings& settings);

}  // namespace victorious
