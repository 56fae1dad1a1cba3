// The experiments on categories (thesis, sections 3.2.1 and 3.6). Each is implemented in the file of its name;
// experiment.cc registers them.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

Expected<Report> RunFigure31(const ExperimentSettings& settings);
Expected<Report> RunFigure319(const ExperimentSettings& settings);
Expected<Report> RunFigure320(const ExperimentSettings& settings);
Expected<Report> RunFigure321(const ExperimentSettings& settings);
Expected<Report> RunTable36(const ExperimentSettings& settings);
Expected<Report> RunTable37(const ExperimentSettings& settings);
Expected<Report> RunTableSteps(const ExperimentSettings& settings);
Expected<Report> RunTableTwelve(const ExperimentSettings& settings);
Expected<Report> RunTableBoxes(const ExperimentSettings& settings);
Expected<Report> RunTableCad(const ExperimentSettings& settings);
Expected<Report> RunTableWindows(const ExperimentSettings& settings);

}  // namespace victorious
