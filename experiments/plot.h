// Draws a plot as SVG: lines, and points with error bars, over two axes with round ticks.
#pragma once

#include <string>
#include <vector>

namespace victorious {

struct PlotPoint {
  double x = 0;
  double y = 0;
  double error = 0;  ///< half the height of the error bar; 0: no bar
};

struct PlotLine {
  std::string name;
  std::vector<PlotPoint> points;
  bool connected = true;
  bool marked = true;  ///< a dot at each point
};

struct PlotAxis {
  std::string label;  ///< with its unit
  double low = 0;     ///< if `low` equals `high`, the axis covers the data
  double high = 0;
  bool logarithmic = false;
};

struct Plot {
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotLine> lines;
};

/// Returns the empirical cumulative distribution of the values, as steps, without marks.
PlotLine MakeCumulativeLine(std::string name, std::vector<double> values);

std::string RenderSvg(const Plot& plot);

}  // namespace victorious
