// The experiments on recognition with CAD models. Each is implemented in the file of its name.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

[[nodiscard]] Expected<Report> RunDescriptorCells(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure318(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigureCalibration(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableFeatures(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableObjectPose(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTableShortlist(const ExperimentSettings& settings);

}  // namespace victorious
