#include "victorious/category/network/output_layout.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/category/network/network_tensor.h"

namespace victorious {
namespace {

using Shapes = std::span<const std::vector<int>>;

// N x M of a shape 1 x N x M, or N x M.
struct TableSize {
  int rows = 0;
  int columns = 0;
};

std::optional<TableSize> TableOf(const std::vector<int>& shape) {
  if (shape.size() == 2) return TableSize{shape[0], shape[1]};
  if (shape.size() == 3 && shape[0] == 1) return TableSize{shape[1], shape[2]};
  return std::nullopt;
}

std::optional<TableSize> OnlyTable(Shapes shapes) { return shapes.size() == 1 ? TableOf(shapes[0]) : std::nullopt; }

bool IsGrid(int cells, cv::Size input) { return cells > 0 && !GridsOf(static_cast<std::size_t>(cells), input).empty(); }

// Two tables of equally many rows, one of four columns.
struct ScoresAndBoxes {
  int rows = 0;
  int scores = 0;  // columns
};

std::optional<ScoresAndBoxes> TwoTables(Shapes shapes) {
  if (shapes.size() != 2) return std::nullopt;
  const auto first = TableOf(shapes[0]);
  const auto second = TableOf(shapes[1]);
  if (!first || !second || first->rows != second->rows) return std::nullopt;
  if (second->columns == 4) return ScoresAndBoxes{first->rows, first->columns};
  if (first->columns == 4) return ScoresAndBoxes{first->rows, second->columns};
  return std::nullopt;
}

constexpr int kMaxQueries = 1000;  // of a DETR; an SSD has thousands of boxes

std::string ShapesText(Shapes shapes) {
  return fmt::format("{}", fmt::join(shapes | std::views::transform([](const auto& s) { return ShapeText(s); }), ", "));
}

}  // namespace

std::string ShapeText(std::span<const int> shape) { return fmt::format("{}", fmt::join(shape, "x")); }

std::vector<CellGrid> GridsOf(std::size_t cells, cv::Size input) {
  constexpr std::array<std::array<int, 2>, 6> kStrides = {{{8, 32}, {8, 64}, {4, 32}, {16, 32}, {8, 16}, {4, 64}}};
  for (const auto& [first, last] : kStrides) {
    std::vector<CellGrid> grids;
    std::size_t count = 0;
    for (int stride = first; stride <= last; stride *= 2) {
      grids.push_back({stride, (input.width + stride - 1) / stride, (input.height + stride - 1) / stride});
      count += grids.back().count();
    }
    if (count == cells) return grids;
  }
  return {};
}

int NanodetBins(Shapes shapes, std::size_t classes, cv::Size input) {
  constexpr int kSides = 4;
  constexpr int kMaxBins = 64;
  const auto bins_of = [](int columns) {
    return columns % kSides == 0 && columns > kSides && columns <= kSides * kMaxBins ? columns / kSides : 0;
  };
  const int class_columns = static_cast<int>(classes);
  if (shapes.size() == 1) {
    const auto table = TableOf(shapes[0]);
    return table && IsGrid(table->rows, input) ? bins_of(table->columns - class_columns) : 0;
  }
  if (shapes.empty() || shapes.size() % 2 != 0) return 0;
  // A table of classes and one of sides for each stride.
  int bins = 0;
  std::vector<int> rows;
  std::size_t of_classes = 0;
  std::size_t of_sides = 0;
  for (const std::vector<int>& shape : shapes) {
    const auto table = TableOf(shape);
    if (!table) return 0;
    rows.push_back(table->rows);
    if (table->columns == class_columns && of_classes <= of_sides) {
      ++of_classes;
      continue;
    }
    const int own = bins_of(table->columns);
    if (own == 0 || (bins != 0 && own != bins)) {
      if (table->columns != class_columns) return 0;
      ++of_classes;
      continue;
    }
    bins = own;
    ++of_sides;
  }
  if (of_classes != of_sides) return 0;
  std::ranges::sort(rows);
  std::size_t cells = 0;
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    if (rows[i] != rows[i + 1] || rows[i] <= 0) return 0;
    cells += static_cast<std::size_t>(rows[i]);
  }
  return GridsOf(cells, input).size() == rows.size() / 2 ? bins : 0;
}

bool FitsLayout(DetectorLayout layout, Shapes shapes, std::size_t classes, cv::Size input, bool exact) {
  if (classes == 0 || classes > kMaxDetectorClasses) return false;
  const int count = static_cast<int>(classes);
  const auto table = OnlyTable(shapes);
  const auto two = TwoTables(shapes);
  constexpr int kBoxColumns = 4;
  switch (layout) {
    case DetectorLayout::kYolov5:
      return table && table->columns == kBoxColumns + 1 + count &&
             (!exact || (table->rows % 3 == 0 && IsGrid(table->rows / 3, input)));
    case DetectorLayout::kYolox:
      return table && table->columns == kBoxColumns + 1 + count && IsGrid(table->rows, input);
    case DetectorLayout::kYolov8:
      if (!table) return false;
      if (table->rows == kBoxColumns + count) return !exact || IsGrid(table->columns, input);
      return table->columns == kBoxColumns + count && (!exact || IsGrid(table->rows, input));
    case DetectorLayout::kYolov10:
      return table && table->columns == 6 && table->rows > 0 && (!exact || table->rows <= kMaxQueries);
    case DetectorLayout::kNanodet:
      return NanodetBins(shapes, classes, input) > 0;
    case DetectorLayout::kFastestdet:
      return shapes.size() == 1 && shapes[0].size() == 4 && shapes[0][0] == 1 &&
             shapes[0][1] == kBoxColumns + 1 + count && shapes[0][2] > 0 && shapes[0][3] > 0;
    case DetectorLayout::kSsd:
      if (shapes.size() == 1 && shapes[0].size() == 4)
        return shapes[0][0] == 1 && shapes[0][1] == 1 && shapes[0][3] == 7;
      return two && two->scores == count + 1 && (!exact || two->rows > kMaxQueries);
    case DetectorLayout::kDetr:
      return two && (two->scores == count + 1 || two->scores == count) && (!exact || two->rows <= kMaxQueries);
    case DetectorLayout::kDarknet:
      return !shapes.empty() && std::ranges::all_of(shapes, [&](const std::vector<int>& shape) {
        return shape.size() == 2 && shape[0] >= 3 && shape[1] == kBoxColumns + 1 + count;
      });
  }
  return false;
}

Expected<DetectorLayout> RecogniseLayout(Shapes shapes, std::size_t classes, cv::Size input) {
  // Three anchors a cell before one, and tables of two dimensions, which only darknet's layers give, before others.
  constexpr std::array kOrder = {DetectorLayout::kDarknet, DetectorLayout::kYolov5,     DetectorLayout::kYolox,
                                 DetectorLayout::kYolov8,  DetectorLayout::kNanodet,    DetectorLayout::kSsd,
                                 DetectorLayout::kDetr,    DetectorLayout::kFastestdet, DetectorLayout::kYolov10};
  for (const DetectorLayout layout : kOrder) {
    if (FitsLayout(layout, shapes, classes, input, true)) return layout;
  }
  constexpr std::size_t kMaxTried = 1000;
  for (const DetectorLayout layout : kOrder) {
    for (std::size_t other = 1; other <= kMaxTried; ++other) {
      if (layout == DetectorLayout::kYolov10 || !FitsLayout(layout, shapes, other, input, true)) continue;
      return Fail(
          ErrorCode::kInvalidArgument,
          fmt::format("its outputs {} are those of a {} with {} classes, and the class list has {}: give the list "
                      "that it was trained with",
                      ShapesText(shapes), ToText(kDetectorLayoutTexts, layout), other, classes));
    }
  }
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("its outputs {} are those of no known detector with {} classes and an input of {}x{}: give "
                          "--layout, or export it with boxes and classes as outputs",
                          ShapesText(shapes), classes, input.width, input.height));
}

}  // namespace victorious
