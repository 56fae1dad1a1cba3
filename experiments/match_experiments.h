// The experiments on matches and the cascade (thesis, sections 3.3 and 3.5); experiment.cc registers them.
#pragma once

#include "experiments/experiment.h"

namespace victorious {

[[nodiscard]] Expected<Report> RunChapter3Filters(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunChapter3Sweeps(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure310(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure311(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure312(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure313(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure314(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure315(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunFigure316(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable32(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable33(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable34(const ExperimentSettings& settings);
[[nodiscard]] Expected<Report> RunTable35(const ExperimentSettings& settings);

}  // namespace victorious
