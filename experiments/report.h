// The result of an experiment: a table with named columns, notes, and a plot.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "experiments/plot.h"
#include "victorious/base/error.h"

namespace victorious {

/// A mean over seeds with its standard error; the error of a single value is 0.
struct MeanWithError {
  double mean = 0;
  double standard_error = 0;
};

MeanWithError ComputeMean(const std::vector<double>& values);

using Cell = std::variant<std::string, double, MeanWithError>;

/// "-" without values. @param percent  0 to 100
Cell FormatPercentile(const std::vector<double>& values, double percent);

struct Report {
  std::string name;                ///< of the experiment
  std::string title;               ///< one line
  std::vector<std::string> notes;  ///< method: seeds, data, differences from the thesis
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;  ///< each as long as `columns`
  Plot plot;                            ///< not written if it has no lines
};

/// Writes NAME.json, NAME.csv and, if there is a plot, NAME.svg. In CSV a MeanWithError takes two columns, the second
/// named `COLUMN standard error`.
[[nodiscard]] Status WriteReport(const Report& report, const std::filesystem::path& folder);

/// Formats title, table and notes as Markdown.
std::string ToMarkdown(const Report& report);

}  // namespace victorious
