// The thesis's tables and figures, each repeated by one file of this folder and one row of the registry.
// A run gives a Report, which is written as NAME.json, NAME.csv and a plot, NAME.svg; figures that are pictures write
// NAME.png beside them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/report.h"

namespace victorious {

struct ExperimentSettings {
  std::filesystem::path data;    ///< the folder of outside data
  std::filesystem::path scenes;  ///< the folder of scene files that pictures are drawn from
  std::filesystem::path out;     ///< where pictures go; the report is written by RunExperiment
  int seeds = 20;                ///< random splits, for means with standard errors
  /// Of chapters 4 and 5: the scene files that are flown, by name; empty: those that the experiment chooses.
  std::vector<std::string> movies = {};
  /// Of these flights: at most so many frames each, over the same time; 0: as the scene file has it.
  int frames = 0;
  std::string program = {};  ///< whose results these are; empty: ProgramId()
  const CancelToken* cancel = nullptr;
  std::function<void(std::string_view what)> progress = [](std::string_view) {};  ///< a line, now and then

  [[nodiscard]] Status CheckCancelled() const;
  /// Names what is kept in `out` for the next experiment, by what it was made of, parameters among it, and by the
  /// program: another build makes its own. 16 hexadecimal digits.
  [[nodiscard]] Expected<std::string> KeptAs(const std::string& made_of) const;
  /// `cancel`, or one that never cancels.
  [[nodiscard]] const CancelToken& Cancel() const;
};

struct Experiment {
  const char* name;     ///< "table3.6"
  const char* summary;  ///< one line
  Expected<Report> (*run)(const ExperimentSettings& settings);
};

/// Every experiment, in the thesis's order.
std::span<const Experiment> Experiments();

/// Error: kInvalidArgument for a name that is none.
Expected<const Experiment*> FindExperiment(const std::string& name);

/// Runs the experiment and writes its report. Errors: kInvalidArgument for a name that is none, kNotFound for data that
/// are missing; those of writing.
Expected<Report> RunExperiment(const std::string& name, const ExperimentSettings& settings);

}  // namespace victorious
