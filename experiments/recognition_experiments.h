// The experiments on recognition with CAD models. Each is implemented in the file of its name.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

Expected<Report> RunFigure318(const ExperimentSettings& settings);
Expected<Report> RunFigureCalibration(const ExperimentSettings& settings);
Expected<Report> RunTableFeatures(const ExperimentSettings& settings);
Expected<Report> RunTableObjectPose(const ExperimentSettings& settings);
Expected<Report> RunTableShortlist(const ExperimentSettings& settings);

}  // namespace victorious
