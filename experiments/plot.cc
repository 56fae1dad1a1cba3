#include "experiments/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace victorious {
namespace {

constexpr double kWidth = 640;
constexpr double kHeight = 420;
constexpr double kLeft = 70;
constexpr double kRight = 20;
constexpr double kTop = 40;
constexpr double kBottom = 55;

// Distinguishable by colour-blind readers (Okabe and Ito).
constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"};

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

// Maps values to the axis, 0 at its lower end and 1 at its upper.
class Scale {
 public:
  Scale(const PlotAxis& axis, double low, double high) : logarithmic_(axis.logarithmic) {
    low_ = axis.low == axis.high ? low : axis.low;
    high_ = axis.low == axis.high ? high : axis.high;
    if (logarithmic_) {
      low_ = std::log10(std::max(low_, std::numeric_limits<double>::min()));
      high_ = std::log10(std::max(high_, std::numeric_limits<double>::min()));
    }
    if (!(high_ > low_)) high_ = low_ + 1;
  }

  [[nodiscard]] double Normalise(double value) const {
    if (logarithmic_) value = std::log10(std::max(value, std::numeric_limits<double>::min()));
    return std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
  }

  // About five round values; powers of ten on a logarithmic axis.
  [[nodiscard]] std::vector<double> Ticks() const {
    constexpr double kSome = 5;
    const double raw = (high_ - low_) / kSome;
    const double decade = std::pow(10, std::floor(std::log10(raw)));
    double step = 10 * decade;
    for (const double factor : {5.0, 2.0, 1.0})
      if (factor * decade >= raw) step = factor * decade;
    if (logarithmic_) step = std::max(1.0, std::round(step));
    std::vector<double> ticks;
    for (double tick = std::ceil(low_ / step) * step; tick <= high_ + step * 1e-9; tick += step)
      ticks.push_back(logarithmic_ ? std::pow(10, tick) : tick);
    return ticks;
  }

 private:
  bool logarithmic_;
  double low_;
  double high_;
};

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot), x_(MakeScale(plot, true)), y_(MakeScale(plot, false)) {}

  std::string Draw() {
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        kWidth, kHeight);
    Text(kWidth / 2, kTop / 2 + 4, "middle", plot_.title, "font-weight=\"bold\"");
    DrawAxes();
    for (std::size_t i = 0; i < plot_.lines.size(); ++i) DrawLine(plot_.lines[i], kColours[i % kColours.size()]);
    DrawLegend();
    return svg_ + "</svg>\n";
  }

 private:
  static Scale MakeScale(const Plot& plot, bool of_x) {
    Extent extent;
    for (const PlotLine& line : plot.lines) {
      for (const PlotPoint& point : line.points) {
        extent.Add(of_x ? point.x : point.y - point.error);
        extent.Add(of_x ? point.x : point.y + point.error);
      }
    }
    return {of_x ? plot.x : plot.y, extent.low, extent.high};
  }

  [[nodiscard]] double X(double value) const { return kLeft + x_.Normalise(value) * (kWidth - kLeft - kRight); }
  [[nodiscard]] double Y(double value) const {
    return kHeight - kBottom - y_.Normalise(value) * (kHeight - kTop - kBottom);
  }

  void Text(double x, double y, const char* anchor, const std::string& text, const std::string& more = "") {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, more,
                        Escaped(text));
  }

  void Segment(double x0, double y0, double x1, double y1, const char* colour) {
    svg_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0, y0, x1,
                        y1, colour);
  }

  void DrawAxes() {
    const double right = kWidth - kRight;
    const double bottom = kHeight - kBottom;
    for (const double tick : x_.Ticks()) {
      Segment(X(tick), kTop, X(tick), bottom, "#dddddd");
      Text(X(tick), bottom + 16, "middle", fmt::format("{:.4g}", tick));
    }
    for (const double tick : y_.Ticks()) {
      Segment(kLeft, Y(tick), right, Y(tick), "#dddddd");
      Text(kLeft - 6, Y(tick) + 4, "end", fmt::format("{:.4g}", tick));
    }
    Segment(kLeft, bottom, right, bottom, "black");
    Segment(kLeft, kTop, kLeft, bottom, "black");
    Text((kLeft + right) / 2, kHeight - 14, "middle", plot_.x.label);
    const double middle = (kTop + bottom) / 2;
    Text(18, middle, "middle", plot_.y.label, fmt::format("transform=\"rotate(-90 18 {:.1f})\"", middle));
  }

  void DrawLine(const PlotLine& line, const char* colour) {
    if (line.connected) {
      std::string path;
      for (const PlotPoint& point : line.points) path += fmt::format("{:.1f},{:.1f} ", X(point.x), Y(point.y));
      svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path, colour);
    }
    for (const PlotPoint& point : line.points) {
      if (point.error > 0) Segment(X(point.x), Y(point.y - point.error), X(point.x), Y(point.y + point.error), colour);
      if (line.marked)
        svg_ +=
            fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", X(point.x), Y(point.y), colour);
    }
  }

  // In the bottom right corner, which ROC curves leave free.
  void DrawLegend() {
    double y = kHeight - kBottom - 10 - 16 * (static_cast<double>(plot_.lines.size()) - 1);
    for (std::size_t i = 0; i < plot_.lines.size(); ++i, y += 16) {
      Text(kWidth - kRight - 26, y, "end", plot_.lines[i].name);
      svg_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"8\" fill=\"{}\"/>\n",
                          kWidth - kRight - 20, y - 8, kColours[i % kColours.size()]);
    }
  }

  const Plot& plot_;
  Scale x_;
  Scale y_;
  std::string svg_;
};

}  // namespace

PlotLine MakeCumulativeLine(std::string name, std::vector<double> values) {
  std::ranges::sort(values);
  PlotLine line{.name = std::move(name), .points = {{0, 0}}, .marked = false};
  for (std::size_t i = 0; i < values.size(); ++i) {
    line.points.push_back({values[i], static_cast<double>(i) / static_cast<double>(values.size())});
    line.points.push_back({values[i], static_cast<double>(i + 1) / static_cast<double>(values.size())});
  }
  return line;
}

std::string RenderSvg(const Plot& plot) { return Drawing(plot).Draw(); }

}  // namespace victorious
