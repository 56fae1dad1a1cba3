// The experiments on recognition by CAD models, each in the file of its name.
#pragma once

#include "victorious/evaluate/experiments/experiment.h"

namespace victorious {

Expected<Report> RunFigure318(const ExperimentSettings& settings);
Expected<Report> RunFigureCalibration(const ExperimentSettings& settings);
Expected<Report> RunTableStance(const ExperimentSettings& settings);

}  // namespace victorious
