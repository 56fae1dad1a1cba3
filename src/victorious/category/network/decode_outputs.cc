#include "victorious/category/network/decode_outputs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/category/network/output_layout.h"

namespace victorious {
namespace {

// Rows of a table in a tensor: 1 x N x M, or N x M, also transposed.
class TensorRows {
 public:
  TensorRows(const NetworkTensor& tensor, bool transposed)
      : values_(tensor.values),
        rows_(static_cast<std::size_t>(tensor.shape[tensor.shape.size() - 2])),
        columns_(static_cast<std::size_t>(tensor.shape.back())),
        transposed_(transposed) {
    if (transposed) std::swap(rows_, columns_);
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] double At(std::size_t row, std::size_t column) const {
    return double{values_[transposed_ ? column * rows_ + row : row * columns_ + column]};
  }

 private:
  std::span<const float> values_;
  std::size_t rows_;
  std::size_t columns_;
  bool transposed_;
};

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

Box CentredBox(double x, double y, double width, double height) {
  return {x - width / 2, y - height / 2, width, height};
}

class BoxCollector {
 public:
  explicit BoxCollector(double min_score) : min_score_(min_score) {}

  void Add(const Box& box, std::size_t category, double score) {
    constexpr double kMax_px = 1e6;
    if (!(score >= min_score_) || !(score > 0) || score > kHighestScore) return;
    if (!(std::abs(box.x) < kMax_px && std::abs(box.y) < kMax_px)) return;
    if (!(box.width > 0 && box.width < kMax_px && box.height > 0 && box.height < kMax_px)) return;
    boxes_.push_back({.box = box, .category = category, .score = std::min(score, 1.0)});
  }

  [[nodiscard]] double min_score() const { return min_score_; }
  std::vector<NetworkBox> Take() { return std::move(boxes_); }

 private:
  static constexpr double kHighestScore = 1.001;  // of a probability, rounded

  double min_score_;
  std::vector<NetworkBox> boxes_;
};

struct BestClass {
  std::size_t category = 0;
  double value = 0;
};

// @param first  column of the first class
BestClass FindBest(const TensorRows& table, std::size_t row, std::size_t first, std::size_t classes) {
  BestClass best{0, table.At(row, first)};
  for (std::size_t c = 1; c < classes; ++c) {
    const double value = table.At(row, first + c);
    if (value > best.value || std::isnan(best.value)) best = {c, value};
  }
  return best;
}

using Outputs = std::span<const NetworkTensor>;

void DecodeYolov5(Outputs outputs, std::size_t classes, BoxCollector& found) {
  const TensorRows table(outputs[0], false);
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const double objectness = table.At(r, 4);
    if (!(objectness >= found.min_score())) continue;
    const BestClass best = FindBest(table, r, 5, classes);
    found.Add(CentredBox(table.At(r, 0), table.At(r, 1), table.At(r, 2), table.At(r, 3)), best.category,
              objectness * best.value);
  }
}

void DecodeYolov8(Outputs outputs, std::size_t classes, BoxCollector& found) {
  const auto rows = static_cast<std::size_t>(outputs[0].shape[outputs[0].shape.size() - 2]);
  const TensorRows table(outputs[0], rows == 4 + classes);
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const BestClass best = FindBest(table, r, 4, classes);
    if (!(best.value >= found.min_score())) continue;
    found.Add(CentredBox(table.At(r, 0), table.At(r, 1), table.At(r, 2), table.At(r, 3)), best.category, best.value);
  }
}

void DecodeYolov10(Outputs outputs, std::size_t classes, BoxCollector& found) {
  const TensorRows table(outputs[0], false);
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const double category = table.At(r, 5);
    if (!(category >= 0 && category < static_cast<double>(classes))) continue;
    const double x = table.At(r, 0);
    const double y = table.At(r, 1);
    found.Add({x, y, table.At(r, 2) - x, table.At(r, 3) - y}, static_cast<std::size_t>(category), table.At(r, 4));
  }
}

// Calls `use` with each cell of the grids, in the order of the outputs: its row, grid, column and row in the grid.
template <typename Use>
void ForEachCell(std::span<const CellGrid> grids, const Use& use) {
  std::size_t row = 0;
  for (const CellGrid& grid : grids) {
    for (int y = 0; y < grid.rows; ++y) {
      for (int x = 0; x < grid.columns; ++x) use(row++, grid, x, y);
    }
  }
}

void DecodeYolox(Outputs outputs, std::size_t classes, cv::Size input, BoxCollector& found) {
  const TensorRows table(outputs[0], false);
  ForEachCell(GridsOf(table.rows(), input), [&](std::size_t r, const CellGrid& grid, int x, int y) {
    const double objectness = table.At(r, 4);
    if (!(objectness >= found.min_score())) return;
    const BestClass best = FindBest(table, r, 5, classes);
    found.Add(CentredBox((table.At(r, 0) + x) * grid.stride, (table.At(r, 1) + y) * grid.stride,
                         std::exp(table.At(r, 2)) * grid.stride, std::exp(table.At(r, 3)) * grid.stride),
              best.category, objectness * best.value);
  });
}

// The mean of a distribution given by its logits.
double ExpectedBin(const TensorRows& table, std::size_t row, std::size_t first, std::size_t bins) {
  double highest = table.At(row, first);
  for (std::size_t b = 1; b < bins; ++b) highest = std::max(highest, table.At(row, first + b));
  double sum = 0;
  double weighted = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    const double weight = std::exp(table.At(row, first + b) - highest);
    sum += weight;
    weighted += weight * static_cast<double>(b);
  }
  return weighted / sum;
}

struct NanodetRow {
  const TensorRows& classes;
  const TensorRows& sides;
  std::size_t row;
  std::size_t first_side;  // column
  std::size_t bins;
};

void AddNanodetRow(const NanodetRow& at, std::size_t classes, const CellGrid& grid, double x, double y,
                   BoxCollector& found) {
  const BestClass best = FindBest(at.classes, at.row, 0, classes);
  if (!(best.value >= found.min_score())) return;
  std::array<double, 4> sides{};  // left, top, right, bottom
  for (std::size_t s = 0; s < sides.size(); ++s) {
    sides[s] = ExpectedBin(at.sides, at.row, at.first_side + s * at.bins, at.bins) * grid.stride;
  }
  found.Add({x - sides[0], y - sides[1], sides[0] + sides[2], sides[1] + sides[3]}, best.category, best.value);
}

void DecodeNanodet(Outputs outputs, std::size_t classes, cv::Size input, std::size_t bins, BoxCollector& found) {
  if (outputs.size() == 1) {  // NanoDet-Plus, whose cells are placed by their left-top corner
    const TensorRows table(outputs[0], false);
    ForEachCell(GridsOf(table.rows(), input), [&](std::size_t r, const CellGrid& grid, int x, int y) {
      AddNanodetRow({table, table, r, classes, bins}, classes, grid, x * grid.stride, y * grid.stride, found);
    });
    return;
  }
  // By the number of cells, the largest first; of two tables of equal size, the first is that of the classes.
  std::map<std::size_t, std::vector<TensorRows>, std::greater<>> pairs;
  std::size_t cells = 0;
  for (const NetworkTensor& tensor : outputs) {
    const TensorRows table(tensor, false);
    cells += table.rows();
    pairs[table.rows()].push_back(table);
  }
  const std::vector<CellGrid> grids = GridsOf(cells / 2, input);
  std::size_t g = 0;
  for (auto& [rows, tables] : pairs) {
    if (tables.size() != 2 || g == grids.size() || grids[g].count() != rows) return;
    if (tables[0].columns() != classes) std::swap(tables[0], tables[1]);
    if (tables[0].columns() != classes || tables[1].columns() != 4 * bins) return;
    const CellGrid& grid = grids[g++];
    ForEachCell(std::span(&grid, 1), [&](std::size_t r, const CellGrid& own, int x, int y) {
      AddNanodetRow({tables[0], tables[1], r, 0, bins}, classes, own, (x + 0.5) * own.stride - 0.5,
                    (y + 0.5) * own.stride - 0.5, found);
    });
  }
}

void DecodeFastestdet(Outputs outputs, std::size_t classes, cv::Size input, BoxCollector& found) {
  constexpr double kObjectnessPower = 0.6;
  constexpr double kClassPower = 0.4;
  const NetworkTensor& tensor = outputs[0];
  const auto rows = static_cast<std::size_t>(tensor.shape[2]);
  const auto columns = static_cast<std::size_t>(tensor.shape[3]);
  // A row for each channel, a column for each cell.
  const NetworkTensor flat{.shape = {tensor.shape[1], static_cast<int>(rows * columns)}, .values = tensor.values};
  const TensorRows cells(flat, true);
  for (std::size_t r = 0; r < cells.rows(); ++r) {
    const BestClass best = FindBest(cells, r, 5, classes);
    const double score = std::pow(cells.At(r, 0), kObjectnessPower) * std::pow(best.value, kClassPower);
    if (!(score >= found.min_score())) continue;
    const double x = (static_cast<double>(r % columns) + std::tanh(cells.At(r, 1))) / static_cast<double>(columns);
    const double y = (static_cast<double>(r / columns) + std::tanh(cells.At(r, 2))) / static_cast<double>(rows);
    found.Add(CentredBox(x * input.width, y * input.height, Sigmoid(cells.At(r, 3)) * input.width,
                         Sigmoid(cells.At(r, 4)) * input.height),
              best.category, score);
  }
}

Box ScaledCorners(double x0, double y0, double x1, double y1, cv::Size input) {
  return {x0 * input.width, y0 * input.height, (x1 - x0) * input.width, (y1 - y0) * input.height};
}

// Image, class from 1 on, score, corners.
void DecodeDetectionOutput(const NetworkTensor& tensor, std::size_t classes, cv::Size input, BoxCollector& found) {
  const TensorRows table(tensor, false);
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const double category = table.At(r, 1);
    if (!(category >= 1 && category < static_cast<double>(classes) + 1)) continue;
    found.Add(ScaledCorners(table.At(r, 3), table.At(r, 4), table.At(r, 5), table.At(r, 6), input),
              static_cast<std::size_t>(category) - 1, table.At(r, 2));
  }
}

// The table of scores, then that of boxes.
std::pair<TensorRows, TensorRows> SplitTables(Outputs outputs) {
  const TensorRows first(outputs[0], false);
  const TensorRows second(outputs[1], false);
  return second.columns() == 4 ? std::pair(first, second) : std::pair(second, first);
}

void DecodeSsd(Outputs outputs, std::size_t classes, cv::Size input, BoxCollector& found) {
  if (outputs.size() == 1) return DecodeDetectionOutput(outputs[0], classes, input, found);
  const auto [scores, boxes] = SplitTables(outputs);
  for (std::size_t r = 0; r < scores.rows(); ++r) {
    const BestClass best = FindBest(scores, r, 1, classes);
    if (!(best.value >= found.min_score())) continue;
    found.Add(ScaledCorners(boxes.At(r, 0), boxes.At(r, 1), boxes.At(r, 2), boxes.At(r, 3), input), best.category,
              best.value);
  }
}

void DecodeDetr(Outputs outputs, std::size_t classes, cv::Size input, BoxCollector& found) {
  const auto [logits, boxes] = SplitTables(outputs);
  for (std::size_t r = 0; r < logits.rows(); ++r) {
    const BestClass best = FindBest(logits, r, 0, classes);
    double score = Sigmoid(best.value);
    if (logits.columns() > classes) {  // the last says "nothing"
      const double highest = std::max(best.value, logits.At(r, classes));
      double sum = 0;
      for (std::size_t c = 0; c <= classes; ++c) sum += std::exp(logits.At(r, c) - highest);
      score = std::exp(best.value - highest) / sum;
    }
    found.Add(CentredBox(boxes.At(r, 0) * input.width, boxes.At(r, 1) * input.height, boxes.At(r, 2) * input.width,
                         boxes.At(r, 3) * input.height),
              best.category, score);
  }
}

void DecodeDarknet(Outputs outputs, std::size_t classes, cv::Size input, BoxCollector& found) {
  for (const NetworkTensor& tensor : outputs) {
    const TensorRows table(tensor, false);
    for (std::size_t r = 0; r < table.rows(); ++r) {
      const BestClass best = FindBest(table, r, 5, classes);
      found.Add(CentredBox(table.At(r, 0) * input.width, table.At(r, 1) * input.height, table.At(r, 2) * input.width,
                           table.At(r, 3) * input.height),
                best.category, best.value);
    }
  }
}

bool HasItsValues(const NetworkTensor& tensor) {
  std::size_t count = 1;
  for (const int side : tensor.shape) {
    if (side <= 0 || static_cast<std::size_t>(side) > tensor.values.size()) return false;
    if (count > tensor.values.size() / static_cast<std::size_t>(side)) return false;
    count *= static_cast<std::size_t>(side);
  }
  return !tensor.shape.empty() && count == tensor.values.size();
}

}  // namespace

Expected<std::vector<NetworkBox>> DecodeOutputs(Outputs outputs, const DetectorSettings& settings,
                                                std::size_t classes) {
  const cv::Size input(settings.width, settings.height);
  std::vector<std::vector<int>> shapes;
  std::vector<std::string> texts;
  bool is_whole = classes > 0 && classes <= kMaxDetectorClasses;
  for (const NetworkTensor& tensor : outputs) {
    shapes.push_back(tensor.shape);
    texts.push_back(ShapeText(tensor.shape));
    is_whole = is_whole && HasItsValues(tensor);
  }
  if (!is_whole || !FitsLayout(settings.layout, shapes, classes, input, false)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("its outputs {} are not those of a {} with {} classes and an input of {}x{}",
                            fmt::join(texts, ", "), ToText(kDetectorLayoutTexts, settings.layout), classes,
                            settings.width, settings.height));
  }
  BoxCollector found(settings.min_score);
  switch (settings.layout) {
    case DetectorLayout::kYolov5:
      DecodeYolov5(outputs, classes, found);
      break;
    case DetectorLayout::kYolov8:
      DecodeYolov8(outputs, classes, found);
      break;
    case DetectorLayout::kYolov10:
      DecodeYolov10(outputs, classes, found);
      break;
    case DetectorLayout::kYolox:
      DecodeYolox(outputs, classes, input, found);
      break;
    case DetectorLayout::kNanodet:
      DecodeNanodet(outputs, classes, input, static_cast<std::size_t>(NanodetBins(shapes, classes, input)), found);
      break;
    case DetectorLayout::kFastestdet:
      DecodeFastestdet(outputs, classes, input, found);
      break;
    case DetectorLayout::kSsd:
      DecodeSsd(outputs, classes, input, found);
      break;
    case DetectorLayout::kDetr:
      DecodeDetr(outputs, classes, input, found);
      break;
    case DetectorLayout::kDarknet:
      DecodeDarknet(outputs, classes, input, found);
      break;
  }
  return found.Take();
}

}  // namespace victorious
