#include "victorious/search/recognize/response_map.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "victorious/kernels/window_products.h"

namespace victorious {
namespace {

using Eigen::Vector2d;

// Every second cell of a part: what templates are compared with.
struct CodeMap {
  std::vector<std::int16_t> codes;
  int rows = 0;
  int columns = 0;
};

// @param phase  which of the four first cells is the first
// @param area   in every second cell; beyond the part is mean background
CodeMap TakeCells(const GradientCells& cells, const cv::Point& phase, const cv::Rect& area,
                  const std::array<float, kCellOrientations>& mean) {
  CodeMap map{.codes = {}, .rows = area.height, .columns = area.width};
  map.codes.resize(static_cast<std::size_t>(map.rows) * map.columns * kCellOrientations);
  const std::array<std::uint8_t, kCellOrientations> outside = CodesOf(mean);
  std::int16_t* out = map.codes.data();
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int y = phase.y + kCellStride * (area.y + row);
      const int x = phase.x + kCellStride * (area.x + column);
      if (y < 0 || x < 0 || y >= cells.rows || x >= cells.columns) {
        std::ranges::copy(outside, out);
      } else {
        std::copy_n(cells.at(y, x), kCellOrientations, out);
      }
      out += kCellOrientations;
    }
  }
  return map;
}

}  // namespace

ResponseMap Respond(const GradientCells& cells, const cv::Point& phase, const ShapeBank& bank,
                    const cv::Rect& positions_at, const std::array<float, kCellOrientations>& mean) {
  if (positions_at.empty()) return {};
  const cv::Point to_corner(bank.window / 2, bank.window / 2);
  const cv::Size reach(bank.window - 1, bank.window - 1);
  const CodeMap map = TakeCells(cells, phase, {positions_at.tl() - to_corner, positions_at.size() + reach}, mean);
  const auto window = static_cast<std::size_t>(bank.window);
  const std::size_t rows = map.rows - window + 1;
  const std::size_t columns = map.columns - window + 1;
  std::vector<std::int32_t> sums(bank.templates.size() * rows * columns);
  kernels::WindowProducts(
      {.values = map.codes.data(),
       .rows = static_cast<std::size_t>(map.rows),
       .cols = static_cast<std::size_t>(map.columns),
       .depth = kCellOrientations},
      {.values = bank.weights.data(), .templates = bank.templates.size(), .height = window, .width = window}, sums);
  ResponseMap made{.response = cv::Mat(static_cast<int>(rows), static_cast<int>(columns), CV_32F, cv::Scalar(-1e9)),
                   .which = cv::Mat::zeros(static_cast<int>(rows), static_cast<int>(columns), CV_32S)};
  const std::size_t positions = rows * columns;
  auto* const response = made.response.ptr<float>();
  auto* const which = made.which.ptr<int>();
  for (std::size_t t = 0; t < bank.templates.size(); ++t) {
    const float scale = bank.templates[t].scale;
    const float offset = bank.templates[t].offset;
    for (std::size_t i = 0; i < positions; ++i) {
      const float here = scale * static_cast<float>(sums[t * positions + i]) - offset;
      if (here <= response[i]) continue;
      response[i] = here;
      which[i] = static_cast<int>(t);
    }
  }
  return made;
}

Vector2d PeakOffset(const cv::Mat& responses, const cv::Point& peak) {
  const auto along = [&](const cv::Point& step) {
    const cv::Rect inside({0, 0}, responses.size());
    if (!inside.contains(peak - step) || !inside.contains(peak + step)) return 0.0;
    const double before = responses.at<float>(peak - step);
    const double here = responses.at<float>(peak);
    const double after = responses.at<float>(peak + step);
    const double bend = before - 2 * here + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
  };
  return {along({1, 0}), along({0, 1})};
}

}  // namespace victorious
