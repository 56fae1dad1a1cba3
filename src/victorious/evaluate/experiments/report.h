// What an experiment found: a table of named figures, and a plot.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/evaluate/experiments/plot.h"

namespace victorious {

/// A mean over seeds with its standard error; the error is 0 of a single figure.
struct Measured {
  double mean = 0;
  double standard_error = 0;
};

Measured MeanOf(const std::vector<double>& values);

using Cell = std::variant<std::string, double, Measured>;

struct Report {
  std::string name;                ///< of the experiment
  std::string title;               ///< one line
  std::vector<std::string> notes;  ///< how it was measured: seeds, data, what differs from the thesis
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;  ///< each as long as `columns`
  Plot plot;                            ///< empty of lines: none is drawn
};

/// Writes NAME.json, NAME.csv and, where there is a plot, NAME.svg. In CSV a Measured takes two columns, the second
/// named `COLUMN standard error`.
Status WriteReport(const Report& report, const std::filesystem::path& folder);

/// The table as Markdown.
std::string MarkdownOf(const Report& report);

}  // namespace victorious
