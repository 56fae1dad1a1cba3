// The registry of experiments (`victorious experiment NAME`). Each reproduces a table or figure of the thesis in one
// file of this folder. An experiment returns a Report, which is written as NAME.json, NAME.csv and a plot, NAME.svg;
// figures that are images also write NAME.png.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"

namespace victorious {

struct ExperimentSettings {
  std::filesystem::path data;    ///< folder of external data
  std::filesystem::path scenes;  ///< folder of scene files to render
  std::filesystem::path out;     ///< output folder; also the cache of models, flights and indexes
  int seeds = 20;                ///< number of random splits, for means with standard errors
  /// Chapters 4 and 5: names of the scene files to simulate; empty: the experiment's own choice.
  std::vector<std::string> movies = {};
  /// Maximum number of frames of each simulated flight, spread over the same duration; 0: as in the scene file.
  int frames = 0;
  std::string program = {};  ///< id of the program build, part of the cache key; empty: ProgramId()
  const CancelToken* cancel = nullptr;
  std::function<void(std::string_view what)> progress = [](std::string_view) {};  ///< receives lines of progress

  /// Error: kCancelled if `cancel` is set and cancelled.
  [[nodiscard]] Status CheckCancelled() const;
  /// The key of a result cached in `out`: 16 hexadecimal digits, a hash of its inputs (parameters included) and of the
  /// program build. Another build does not reuse it.
  [[nodiscard]] Expected<std::string> CacheKey(const std::string& inputs) const;
  /// Returns `cancel`, or a token that is never cancelled if it is null.
  [[nodiscard]] const CancelToken& Cancel() const;
};

struct Experiment {
  const char* name;     ///< "table3.6"
  const char* summary;  ///< one line
  Expected<Report> (*run)(const ExperimentSettings& settings);
};

/// All experiments, in the order of the thesis.
std::span<const Experiment> Experiments();

/// Error: kInvalidArgument for an unknown name.
[[nodiscard]] Expected<const Experiment*> FindExperiment(const std::string& name);

/// Runs the experiment and writes its report. Errors: kInvalidArgument for an unknown name, kNotFound for missing data,
/// and those of writing.
[[nodiscard]] Expected<Report> RunExperiment(const std::string& name, const ExperimentSettings& settings);

}  // namespace victorious
