#include "victorious/track/correlation_filter.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "victorious/base/check.h"

namespace victorious {
namespace {

using Complex = std::complex<float>;

constexpr double kResponseWidth = 1.0 / 16;  // standard deviation of y relative to the object's size (Galoogahi 2017)
// Size of the ellipse that models the object, relative to the one inscribed in its box: keeps the object's outline.
constexpr double kEllipseReach = 1.1;
// ADMM: the penalty starts at kInitialGamma of the window's mean energy and grows by kGammaGrowth a step (Galoogahi
// 2017, Li 2018: 10); the first window starts from zero and takes more steps than the later ones.
constexpr float kInitialGamma = 0.1F;
constexpr float kGammaGrowth = 10.0F;
constexpr int kFirstAdmmSteps = 4;
constexpr int kAdmmSteps = 2;    // Li 2018
constexpr int kNewtonSteps = 2;  // of the peak: quadratic convergence from within half a cell

cv::Mat MakeHannWindow(cv::Size cells) {
  cv::Mat taper(cells, CV_32F);
  const auto hann = [](int i, int count) { return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / count); };
  for (int row = 0; row < cells.height; ++row) {
    for (int column = 0; column < cells.width; ++column) {
      taper.at<float>(row, column) = static_cast<float>(hann(row, cells.height) * hann(column, cells.width));
    }
  }
  return taper;
}

// The spectrum of a periodic Gaussian with its peak at (0, 0); it is real.
cv::Mat DesiredSpectrum(const FilterShape& shape) {
  const double sigma = kResponseWidth * std::sqrt(shape.object_cells.width * shape.object_cells.height);
  const auto distance = [](int i, int count) { return std::min(i, count - i); };
  cv::Mat desired(shape.cells, CV_32F);
  for (int row = 0; row < desired.rows; ++row) {
    for (int column = 0; column < desired.cols; ++column) {
      const double squared = std::pow(distance(row, desired.rows), 2) + std::pow(distance(column, desired.cols), 2);
      desired.at<float>(row, column) = static_cast<float>(std::exp(-0.5 * squared / (sigma * sigma)));
    }
  }
  cv::Mat spectrum;
  cv::dft(desired, spectrum, cv::DFT_COMPLEX_OUTPUT);
  cv::Mat real;
  cv::extractChannel(spectrum, real, 0);
  return real;
}

// 1 on the object, 0 outside. The object is modelled as an ellipse, since it seldom reaches the corners of its box.
cv::Mat MakeObjectMask(const FilterShape& shape) {
  const double cells = std::sqrt(shape.object_cells.area()) / 2;
  cv::Mat mask(shape.cells, CV_32F);
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      const double x = (column + 0.5 - mask.cols / 2.0) / (shape.object_cells.width / 2);
      const double y = (row + 0.5 - mask.rows / 2.0) / (shape.object_cells.height / 2);
      const double from_edge_cells = (1 - std::hypot(x, y) / kEllipseReach) * cells;
      mask.at<float>(row, column) = static_cast<float>(std::clamp(from_edge_cells + 0.5, 0.0, 1.0));
    }
  }
  return mask;
}

Complex* Values(cv::Mat& spectrum) { return reinterpret_cast<Complex*>(spectrum.ptr<float>()); }
const Complex* Values(const cv::Mat& spectrum) { return reinterpret_cast<const Complex*>(spectrum.ptr<float>()); }

std::vector<cv::Mat> Zeros(std::size_t count, cv::Size size) {
  std::vector<cv::Mat> zeros;
  for (std::size_t i = 0; i < count; ++i) zeros.emplace_back(cv::Mat::zeros(size, CV_32FC2));
  return zeros;
}

// Value, gradient and Hessian at a sub-pixel position of the real image with a given spectrum.
struct LocalExpansion {
  double value = 0;
  cv::Vec2d gradient;
  cv::Matx22d hessian;
};

LocalExpansion ExpandAt(const cv::Mat& spectrum, cv::Point2d position) {
  LocalExpansion expansion;
  const int rows = spectrum.rows;
  const int columns = spectrum.cols;
  for (int row = 0; row < rows; ++row) {
    const double fy = 2 * std::numbers::pi * (row <= rows / 2 ? row : row - rows) / rows;
    const Complex* values = reinterpret_cast<const Complex*>(spectrum.ptr<float>(row));
    for (int column = 0; column < columns; ++column) {
      const double fx = 2 * std::numbers::pi * (column <= columns / 2 ? column : column - columns) / columns;
      const double phase = fx * position.x + fy * position.y;
      const double c = std::cos(phase);
      const double s = std::sin(phase);
      const double even = values[column].real() * c - values[column].imag() * s;
      const double odd = -values[column].real() * s - values[column].imag() * c;
      expansion.value += even;
      expansion.gradient += cv::Vec2d(fx * odd, fy * odd);
      expansion.hessian += cv::Matx22d(-fx * fx * even, -fx * fy * even, -fx * fy * even, -fy * fy * even);
    }
  }
  const double scale = 1.0 / (rows * columns);
  expansion.value *= scale;
  expansion.gradient *= scale;
  expansion.hessian *= scale;
  return expansion;
}

// Newton iterations from the highest pixel to the sub-pixel maximum.
cv::Point2d RefinePeak(const cv::Mat& spectrum, cv::Point2d start) {
  cv::Point2d position = start;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const LocalExpansion expansion = ExpandAt(spectrum, position);
    if (!(expansion.hessian(0, 0) < 0 && cv::determinant(expansion.hessian) > 0)) return start;
    const cv::Vec2d move = expansion.hessian.inv() * expansion.gradient;
    position -= cv::Point2d(move[0], move[1]);
    if (std::abs(position.x - start.x) > 1 || std::abs(position.y - start.y) > 1) return start;
  }
  return position;
}

// The peak-to-sidelobe ratio: (peak - mean) / standard deviation over the map outside the peak.
double Sharpness(const cv::Mat& map, cv::Point peak, double height, const cv::Size2f& object_cells) {
  cv::Mat rest(map.size(), CV_8U, cv::Scalar(255));
  const auto reach_x = std::max(2, static_cast<int>(object_cells.width / 4));
  const auto reach_y = std::max(2, static_cast<int>(object_cells.height / 4));
  rest(cv::Rect(peak.x - reach_x, peak.y - reach_y, 2 * reach_x + 1, 2 * reach_y + 1) & cv::Rect({0, 0}, map.size())) =
      0;
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(map, mean, deviation, rest);
  return (height - mean[0]) / std::max(1e-6, deviation[0]);
}

}  // namespace

CorrelationFilter::CorrelationFilter(const FilterShape& shape)
    : shape_(shape),
      taper_(MakeHannWindow(shape.cells)),
      mask_(MakeObjectMask(shape)),
      desired_spectrum_(DesiredSpectrum(shape)) {}

std::vector<cv::Mat> CorrelationFilter::ComputeSpectra(const CellFeatures& window) const {
  std::vector<cv::Mat> spectra(window.size());
  for (std::size_t d = 0; d < window.size(); ++d) {
    VICTORIOUS_CHECK(window[d].size() == shape_.cells);
    cv::dft(window[d].mul(taper_), spectra[d], cv::DFT_COMPLEX_OUTPUT);
  }
  return spectra;
}

void CorrelationFilter::Update(const CellFeatures& window, double temporal_weight) {
  const std::vector<cv::Mat> x = ComputeSpectra(window);
  const std::size_t channels = x.size();
  const auto cells = static_cast<std::size_t>(shape_.cells.area());
  const bool first = filter_.empty();
  if (first) filter_ = Zeros(channels, shape_.cells);
  VICTORIOUS_CHECK(filter_.size() == channels);

  std::vector<float> energy(cells, 0.0F);
  for (const cv::Mat& spectrum : x) {
    const Complex* values = Values(spectrum);
    for (std::size_t i = 0; i < cells; ++i) energy[i] += std::norm(values[i]);
  }
  // Weights are relative to the mean energy per cell, and so independent of the image's contrast.
  double total = 0;
  for (const float value : energy) total += value;
  const auto mean_energy = static_cast<float>(std::max(1e-12, total / static_cast<double>(cells)));
  const float mu = first ? 0.0F : static_cast<float>(temporal_weight) * mean_energy;

  const int steps = first ? kFirstAdmmSteps : kAdmmSteps;
  float gamma = kInitialGamma * mean_energy;
  const std::vector<cv::Mat> before = std::exchange(filter_, Zeros(channels, shape_.cells));
  std::vector<cv::Mat> auxiliary =
      Zeros(channels, shape_.cells);  // g: the auxiliary copy of f that satisfies the constraint
  std::vector<cv::Mat> dual = Zeros(channels, shape_.cells);  // h: the scaled dual variable of f = g
  std::vector<Complex> projection(cells);
  const auto* y = desired_spectrum_.ptr<float>();
  for (int step = 0; step < steps; ++step) {
    const float c = mu + gamma;
    // rho = x y + mu before + gamma (g - h), stored in filter_; then f = (rho - x (x^H rho) / (c + x^H x)) / c.
    std::ranges::fill(projection, Complex(0, 0));
    for (std::size_t d = 0; d < channels; ++d) {
      Complex* f = Values(filter_[d]);
      const Complex* xd = Values(x[d]);
      const Complex* b = Values(before[d]);
      const Complex* g = Values(auxiliary[d]);
      const Complex* h = Values(dual[d]);
      for (std::size_t i = 0; i < cells; ++i) {
        f[i] = xd[i] * y[i] + mu * b[i] + gamma * (g[i] - h[i]);
        const float re = xd[i].real() * f[i].real() + xd[i].imag() * f[i].imag();
        const float im = xd[i].real() * f[i].imag() - xd[i].imag() * f[i].real();
        projection[i] += Complex(re, im);
      }
    }
    for (std::size_t i = 0; i < cells; ++i) projection[i] /= c + energy[i];
    for (std::size_t d = 0; d < channels; ++d) {
      Complex* f = Values(filter_[d]);
      const Complex* xd = Values(x[d]);
      Complex* h = Values(dual[d]);
      for (std::size_t i = 0; i < cells; ++i) {
        const float re = xd[i].real() * projection[i].real() - xd[i].imag() * projection[i].imag();
        const float im = xd[i].real() * projection[i].imag() + xd[i].imag() * projection[i].real();
        f[i] = (f[i] - Complex(re, im)) / c;
        h[i] += f[i];
      }
      // g = f + h on the object, 0 outside. These are spectra of real images: the inverse transform is real.
      cv::Mat both;
      cv::idft(dual[d], both, cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
      cv::dft(both.mul(mask_), auxiliary[d], cv::DFT_COMPLEX_OUTPUT);
      const Complex* g = Values(auxiliary[d]);
      for (std::size_t i = 0; i < cells; ++i) h[i] -= g[i];
    }
    gamma *= kGammaGrowth;
  }
}

FilterResponse CorrelationFilter::ComputeResponse(const CellFeatures& window) const {
  VICTORIOUS_CHECK(window.size() == filter_.size());
  cv::Mat sum = cv::Mat::zeros(shape_.cells, CV_32FC2);
  const std::vector<cv::Mat> x = ComputeSpectra(window);
  for (std::size_t d = 0; d < x.size(); ++d) {
    cv::Mat product;
    cv::mulSpectrums(x[d], filter_[d], product, 0, true);
    sum += product;
  }
  cv::Mat map;
  cv::idft(sum, map, cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
  FilterResponse response;
  cv::Point peak;
  cv::minMaxLoc(map, nullptr, &response.height, nullptr, &peak);
  const cv::Point2d refined = RefinePeak(sum, peak);
  // Shifts are periodic: those beyond half the window are negative.
  const auto centred = [](double position, int count) { return position > count / 2 ? position - count : position; };
  response.peak = {centred(refined.x, map.cols), centred(refined.y, map.rows)};
  const cv::Point middle(map.cols / 2, map.rows / 2);
  response.map.create(map.size(), CV_32F);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.cols; ++column) {
      response.map.at<float>((row + middle.y) % map.rows, (column + middle.x) % map.cols) = map.at<float>(row, column);
    }
  }
  const cv::Point centred_peak((peak.x + middle.x) % map.cols, (peak.y + middle.y) % map.rows);
  response.sharpness = Sharpness(response.map, centred_peak, response.height, shape_.object_cells);
  return response;
}

}  // namespace victorious
